"""The window that puts the views together."""
