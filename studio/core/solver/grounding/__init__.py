"""Grounding: a motion on one body, with its feet and other contacts on the ground, before any constraint."""
