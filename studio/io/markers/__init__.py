"""Optical markers as a capture, and marker maps, which give their positions on the body."""
