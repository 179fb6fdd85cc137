"""Drags of the timeline, one gesture a file: start, update, finish or cancel."""
