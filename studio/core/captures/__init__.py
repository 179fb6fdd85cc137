"""Captures, and their analysis: contacts, touching hands, remarks."""
