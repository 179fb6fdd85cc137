"""Panels around the 3D view, one module each."""
