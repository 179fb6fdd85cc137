"""Constraints of the user: one file a kind; priority, chain and activation are common to all."""
