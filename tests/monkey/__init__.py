"""A monkey at the real window."""
