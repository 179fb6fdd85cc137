"""Background work: the newest request wins, results are values."""
