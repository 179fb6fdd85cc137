"""Captures, and what is found out about them: contacts, touching hands, remarks."""
