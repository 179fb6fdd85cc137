"""Formats of captures added to the studio."""
