"""Motions, bodies and their adaptation: frozen values and pure functions. No toolkit, no files."""
