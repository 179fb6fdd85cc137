"""Motions made by hand: keyed targets, splines through them, and the studio's own limb kernel to reach them."""
