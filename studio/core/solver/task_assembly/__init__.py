"""Constraints as arrays for the kernels: targets, chains, task records and self-contact."""
