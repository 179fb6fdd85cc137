"""Mouse drags of the timeline, one kind in each module."""
