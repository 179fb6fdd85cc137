"""The verbs of the command line, one file each; none needs a window."""
