"""Docks round the viewport, one a file."""
