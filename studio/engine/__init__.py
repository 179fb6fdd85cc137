"""Background solving for the window: the newest request wins, and results are immutable values."""
