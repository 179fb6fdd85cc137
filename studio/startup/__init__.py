"""Before anything else: what a process sets up, what it lacks, and kernels compiled in the background."""
