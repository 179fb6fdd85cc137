"""Background work of the window: the newest request wins, results are immutable values."""
