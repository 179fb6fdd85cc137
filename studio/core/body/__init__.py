"""Bodies: joints, measures, characters, and the recognition of a human body in any skeleton."""
