"""BVH, text of joints and their channels: read, interpreted as a capture, written."""
