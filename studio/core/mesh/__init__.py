"""Meshes: skins, their looks and hands, the room they take up, and how far away they are."""
