"""Whole jobs that the command line, the window and scripts share: a capture or a project adapted, with its report."""
