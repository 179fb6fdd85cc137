"""Performers on one stage: rows of clips, props, and dependencies between performers."""
