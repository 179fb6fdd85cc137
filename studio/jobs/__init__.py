"""Whole jobs shared by the command line, the window and scripts: a capture or a project adapted, with its report."""
