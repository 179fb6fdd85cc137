"""Rows of the timeline, one kind in each file: layout, drawing, and hit tests."""
