"""The window and the functions of its actions."""
