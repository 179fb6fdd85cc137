"""Optical markers as a capture, and the maps that say where they lie on the body."""
