"""Adaptation of a motion to a character with constraints."""
