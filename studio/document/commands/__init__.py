"""What can be undone: every change of the project is one of these."""
