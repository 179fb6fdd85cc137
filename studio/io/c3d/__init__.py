"""C3D, optical markers: read with their events, understood as a capture, written."""
