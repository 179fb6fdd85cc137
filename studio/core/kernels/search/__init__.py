"""The search of one frame: levels of priority, steps in the null space of those above, joints and their state."""
