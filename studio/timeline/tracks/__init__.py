"""Rows of the timeline, one kind a file: layout, drawing, and hit tests."""
