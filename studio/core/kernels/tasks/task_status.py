"""Status of a task at one frame, and all functions that change it.

    INACTIVE --activation > 0--> ACTIVE --cannot be met beside higher levels--> DROPPED
                                   |
                                   +--in transition, or out of reach in a blend--> IN_TRANSITION

No other module writes ``status``.
"""

from studio.core.kernels.compiling import small_kernel

INACTIVE, ACTIVE, DROPPED, IN_TRANSITION = 0, 1, 2, 3
"""Values of a task's ``status``: a dropped task yields to higher levels; a task in transition is not solved any more,
but its residual is blended.
"""
UNPINNED, PINNED_TO_RESIDUAL, PINNED_TO_ROTATION = 0, 1, 2
"""Values of a task's ``pinned``: free, held at its residual, or, for a look-at task that looks away, held at its
rotation.
"""


@small_kernel
def set_initial_status(row, activation):
    """Make a task active, or inactive without ``activation``, and unpin it."""
    row.status, row.pinned = ACTIVE if activation > 0.0 else INACTIVE, UNPINNED


@small_kernel
def drop_task(row):
    """Drop a task that cannot be met beside higher levels at this frame."""
    row.status, row.engaged = DROPPED, 0


@small_kernel
def begin_transition(row):
    """Put a task into transition: its residual is blended, and not solved any more."""
    row.status = IN_TRANSITION


@small_kernel
def pin_to_residual(row):
    """Make a task active again, pinned to its residual."""
    row.status, row.pinned = ACTIVE, PINNED_TO_RESIDUAL
