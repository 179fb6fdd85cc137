"""Drags of the timeline, one gesture in each file: start, update, finish or cancel."""
