"""Morphology-independent motions: normalise captures, realise motions on bodies, and edit motions."""
