"""Meshes: skins, their appearance and hands, and collision volumes."""
