"""Constraints of the user, one file for each kind; all have a priority, a chain and an activation."""
