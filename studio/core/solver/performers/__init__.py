"""Performers on one stage: their clips as motions, props, and dependencies between performers."""
