"""BVH, text of joints and their channels: read, understood as a capture, written."""
