"""Morpho Studio: adapts captured motions live to any character."""

__version__ = "0.1.0"
