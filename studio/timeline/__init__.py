"""Bars, handles, curves and error strips over time."""
