"""Grounding: a motion on one body and on the ground, before any constraint."""
