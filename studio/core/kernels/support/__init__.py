"""Feet, hands and knees in contact with the ground."""
