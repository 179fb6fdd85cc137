"""Solved motions without jolts."""
