"""FBX, read by ufbx in a child process: motions and characters."""
