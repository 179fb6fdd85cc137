"""Optical markers: trials, marker maps, joint centres, and the body solved from them."""
