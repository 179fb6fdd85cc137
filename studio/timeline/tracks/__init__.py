"""Tracks of the timeline, one kind in each module: layout, painting, and hit tests."""
