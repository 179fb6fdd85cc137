"""C3D, optical markers: read with their events, interpreted as a capture, written."""
