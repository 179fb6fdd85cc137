"""Docks around the viewport, one file for each."""
