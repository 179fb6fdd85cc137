"""Curves over time: keys, their tangents, and the activation of constraints."""
