"""Start-up: process setup, detection of missing system libraries, and compilation of kernels in the background."""
