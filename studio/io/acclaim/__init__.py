"""Acclaim's pair of files: a skeleton (ASF) and the motions recorded on it (AMC)."""
