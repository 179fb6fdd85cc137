"""The one thing that changes, and the undo commands by which it changes."""
