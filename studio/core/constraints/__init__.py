"""Constraints of the user, one file for each kind; priority, chain and activation are common to all."""
