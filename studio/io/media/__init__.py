"""Films, footage and sounds, by way of ffmpeg; what is heard goes out by way of miniaudio."""
