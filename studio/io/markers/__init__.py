"""Interpretation of optical markers as captures, and files of marker maps."""
