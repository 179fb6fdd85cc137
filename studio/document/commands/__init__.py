"""Undo commands: every change of the project is one of them."""
