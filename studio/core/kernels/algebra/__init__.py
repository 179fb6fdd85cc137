"""Rotations, points and small matrices."""
