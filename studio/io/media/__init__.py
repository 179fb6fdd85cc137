"""Films, footage and sounds by ffmpeg, and sound output by miniaudio."""
