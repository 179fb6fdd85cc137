"""Scenes of other programs (FBX, USD), read by a library in a child process that returns plain arrays."""
