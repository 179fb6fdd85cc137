"""Start-up: process setup, missing system libraries, and kernels compiled in the background."""
