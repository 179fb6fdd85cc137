"""BVH files (text of joints and their channels): read, interpreted as a capture, and written."""
