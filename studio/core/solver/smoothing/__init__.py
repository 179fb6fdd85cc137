"""Smoothing of acceleration peaks in solved motions."""
