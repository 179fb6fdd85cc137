"""Figures: characters as read from any file, with joints, skin and pictures, and the body found in them."""
