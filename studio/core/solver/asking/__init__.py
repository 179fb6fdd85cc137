"""Constraints as arrays for the kernels: targets, chains, tasks and self-contact."""
