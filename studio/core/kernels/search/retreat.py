"""One retreat: back along the step of a lower level until no task above it is disturbed (METHOD 6).

A ``share`` names a pose on the way, from 0, where the levels above stand, to 1, where the step led. Who retreats poses
the body there and says what that disturbs, until one is found that leaves ``AIM`` of what is allowed:

    begin_retreat(0.0, disturbs, allowed, retreat)
    while tries_share(retreat):
        note_disturbance(pose_at(retreat.share), retreat)

Regula falsi (Illinois; Dowell and Jarratt 1971) rather than halving, so that near frames go back to near poses. In the
end the body is posed at the greatest share that is known to do, perhaps 0; where even that ``disturbs`` as much as is
allowed, who retreats gives up the step.
"""

import numpy as np

from studio.core.kernels.compiling import kernel

AIM, NEAR = 0.7, 0.02
"""Part of the allowed disturbance that a retreat is to leave, and how near to that it ends."""
TRIES = 8
"""Shares that are tried before the greatest that is known to do is taken: 7 find it where 10 cm are disturbed, in
proportion to the share or up to its fifth power.
"""
RETREAT = np.dtype(
    [
        *((name, np.float64) for name in ("share", "disturbs", "allowed", "least", "below", "most", "above", "last")),
        ("tries", np.int64),
    ],
    align=True,
)
"""A retreat: the ``share`` posed last, what that ``disturbs`` and how much is ``allowed``; the ``least`` and ``most``
between which the share lies, and by how much what they disturb is ``below`` and ``above`` the aim; the same of the
``last`` share; how many ``tries`` there were.
"""


@kernel
def begin_retreat(at_start, at_end, allowed, retreat):
    """Set ``retreat`` (a record of ``RETREAT``) at the end of a way, with what is disturbed there and at its start.

    Metres or radians, of which less than ``allowed`` may be disturbed.
    """
    retreat.allowed, retreat.tries = allowed, 0
    retreat.share, retreat.disturbs, retreat.last = 1.0, at_end, 0.0
    retreat.least, retreat.below = 0.0, excess(at_start, allowed)
    retreat.most, retreat.above = 1.0, excess(at_end, allowed)


@kernel
def tries_share(retreat):
    """Whether another share is to be tried, and which."""
    if retreat.tries > 0 and abs(excess(retreat.disturbs, retreat.allowed)) < NEAR * retreat.allowed:
        return False
    if retreat.tries == TRIES:
        if retreat.share == retreat.least:
            return False
        retreat.share = retreat.least
        return True
    slope = retreat.above - retreat.below
    retreat.share = (retreat.least * retreat.above - retreat.most * retreat.below) / slope
    retreat.tries += 1
    return True


@kernel
def note_disturbance(disturbs, retreat):
    """Note what is disturbed at the share just posed."""
    over = excess(disturbs, retreat.allowed)
    retreat.disturbs = disturbs
    if over < 0.0:
        retreat.above *= 0.5 if retreat.last < 0.0 else 1.0
        retreat.least, retreat.below = retreat.share, over
    else:
        retreat.below *= 0.5 if retreat.last > 0.0 else 1.0
        retreat.most, retreat.above = retreat.share, over
    retreat.last = over


@kernel
def excess(disturbs, allowed):
    """How far a disturbance is beyond the aim, at most what is allowed: what disturbs more is no worse."""
    return min(disturbs - AIM * allowed, allowed)
