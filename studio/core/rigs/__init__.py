"""Bodies as skeletons of other programs: joints, zero poses, root motion, fingers, and bound skins."""
