"""Solution of one frame: priority levels, null-space steps, back-tracking, and the state of the joints."""
