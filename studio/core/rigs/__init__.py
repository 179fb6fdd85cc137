"""Bodies as skeletons of other programs: joints, zero poses, root motion, bound skins."""
