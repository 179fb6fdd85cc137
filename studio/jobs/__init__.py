"""Whole jobs shared by the command line, the window and scripts: adaptation of a capture or a project, with
its report.
"""
