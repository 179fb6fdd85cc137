"""Undo commands, through which every change of the project is made."""
