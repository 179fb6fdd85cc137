"""Constraints as the arrays that the kernels take: targets, chains, areas, self-contact."""
