"""Kernels that relate frames: activation transitions, and smoothing where single frames have acceleration peaks."""
