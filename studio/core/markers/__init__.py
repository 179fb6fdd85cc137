"""Optical markers: trials, marker maps, joint centres, and the body that is solved from them."""
