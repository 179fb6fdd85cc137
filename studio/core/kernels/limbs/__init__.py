"""Limbs in closed form."""
