"""Captures and their analysis: contacts with the ground, hand contacts, faults and warnings."""
