"""What the mouse does over time, a gesture a file: start, update, finish or cancel."""
