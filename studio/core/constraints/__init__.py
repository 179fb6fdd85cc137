"""What the user asks of a motion, one kind a file."""
