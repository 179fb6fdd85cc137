"""Verbs of the command line, one file for each; none needs a window."""
