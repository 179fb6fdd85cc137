"""USD files, read in a child process, and written with their materials."""
