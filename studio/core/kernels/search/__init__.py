"""Solution of one frame: levels of priority, null-space steps, back-tracking, and the joints' state."""
