"""Optical markers: trials, which marker is what, joint centres, and the body that they move."""
