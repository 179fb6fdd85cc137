"""The document, and the undo commands by which it changes."""
