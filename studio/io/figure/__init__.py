"""Character as read from any file: its joints, skin and pictures, and the body found in it."""
