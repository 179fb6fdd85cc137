"""USD, written with its materials."""
