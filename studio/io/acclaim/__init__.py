"""Acclaim's pair of files: a skeleton (ASF) and the motions that were recorded on it (AMC)."""
