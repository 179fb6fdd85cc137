"""Films and sounds, by way of ffmpeg."""
