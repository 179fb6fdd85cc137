"""Smooth steps from one number to another."""

from studio.core.kernels.compiling import kernel


@kernel
def smoothstep(t):
    """Quintic ease 6t^5 - 15t^4 + 10t^3 of t in [0, 1]: level, without velocity or acceleration at both ends.

    METHOD (6).
    """
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0)


@kernel
def lack(height, room):
    """By how much to raise what is at ``height`` so that it keeps above 0: twice continuously differentiable.

    METHOD (7).
    """
    if height >= room:
        return 0.0
    if height <= -room:
        return -height
    share = height / room
    return room * (1.0 - share) ** 3 * (3.0 + share) / 16.0
