"""Mannequins: smooth bodies computed from a morphology and a few girths."""
