"""Smooth step and smooth lower bound of one number."""

from studio.core.kernels.compiling import kernel


@kernel
def smoothstep(t):
    """Quintic 6t^5 - 15t^4 + 10t^3 of t in [0, 1], with zero velocity and acceleration at both ends. METHOD (6)."""
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0)


@kernel
def penetration_correction(height, margin):
    """Correction in metres to be added to ``height`` to keep it above 0: twice continuously differentiable, 0 from
    ``margin`` metres on (METHOD (7)).
    """
    if height >= margin:
        return 0.0
    if height <= -margin:
        return -height
    fraction = height / margin
    return margin * (1.0 - fraction) ** 3 * (3.0 + fraction) / 16.0
