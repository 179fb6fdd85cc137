"""The tasks of the solver: one record of ``TASK`` a constraint, with room for what it is at the frame being solved.

Its fields come in groups: what is asked in all frames, what it comes to at one, how far its limbs reach for it, how
stiff these are, what is blended on its edges, and what it has once its level is solved. Fields of two have one for each
of its *ends*: the point that is brought somewhere, and the other point of a distance, or what the task follows on its
own body.
"""

import numpy as np

INACTIVE, ACTIVE, GIVEN_UP, ON_EDGE = 0, 1, 2, 3
"""The ``status`` of a task at a frame: one that is given up is left as it is for those above it; one on the edge of its
activation, or out of reach in what is blended, is not solved any more.
"""
FREE, PINNED, PINNED_TURN = 0, 1, 2
"""Whether a task is ``pinned`` to what it has (``kernels.time.easing``): a look that looks away to its turn, rather
than to what it misses.
"""

STRICT = 2e-4
"""Metres or radians by which a lower level may change a residual of a higher one, in all (METHOD 6, "The law"); what is
met, held or at rest are parts of it.
"""

_FLAG, _REAL = np.int64, np.float64

ASKED = [
    ("kind", _FLAG),
    ("rank", _FLAG),
    ("points", _FLAG, (2,)),
    ("segments", _FLAG, (2,)),
    ("limbs", _FLAG, (2,)),
    ("offsets", _REAL, (2, 3)),
    ("freedoms", _REAL, (2, 2)),
    ("relative", _REAL, (3, 3)),
    ("blends", _FLAG),
    ("weight", _REAL),
    ("shares", _REAL, (2,)),
    ("axes", _FLAG),
    ("helped", _FLAG),
]
"""In all frames: its kind (``kernels.tasks.goals``) and the rank of its level; of each end the point of the body (-1
none), the segment that this moves with, its limb (-1 none), the offset from the point, and how freely limb and hand or
foot move; its turn in the axes of what it follows; whether its edges blend what is solved
(``kernels.time.activation_blend``); its weight among its equals; the share of each end in a distance; 3 axes where a
balance counts heights too, else 2; whether joints beside its limbs may move.
"""
NOW = [
    ("share", _REAL),
    ("counts", _REAL),
    ("status", _FLAG),
    ("pinned", _FLAG),
    ("secondary", _FLAG),
    ("engaged", _FLAG),
    ("places", _REAL, (2, 3)),
    ("turn", _REAL, (3, 3)),
    ("distance", _REAL),
    ("begin", _REAL, (3,)),
]
"""At one frame: its activation; its weight beside the heaviest of its level; its status; whether it is pinned to what
it has (then ``relative`` is where that is in the axes of what it follows); whether its limb has a place before it;
whether its area is entered; the places, the turn or the distance that it is to have; where the unsolved pose has its
first point or the centre of mass.
"""
REACH = [
    ("longest", _REAL, (2,)),
    ("folds", _REAL, (2,)),
    ("comforts", _REAL, (2,)),
    ("reaches", _REAL, (2,)),
    ("slack", _REAL, (2,)),
    ("origins", _REAL, (2, 3)),
    ("easings", _REAL, (2,)),
]
"""Of each limb: the metres that it can span at most and at least; the part of that which it takes freely; the metres
that it is to take, the chain doing the rest but for the slack; where its root was; the metres below which it folds ever
less.
"""
STIFFNESS = [
    ("stiff", _FLAG),
    ("parts", _REAL, (2, 2)),
    ("change", _REAL, (2, 2)),
    ("most", _REAL, (2, 2)),
    ("own", _REAL, (2,)),
]
"""Of its limbs' upper and lower segments, as ``kernels.limbs.stiffness`` has them."""
EDGE = [("blended_miss", _REAL), ("miss_change", _REAL)]
"""On edges (``kernels.time.activation_blend``): what both poses miss, blended, and how far apart that is."""
KEPT = [
    ("kept_miss", _REAL),
    ("kept_places", _REAL, (2, 3)),
    ("kept_roots", _REAL, (2, 3)),
    ("kept_turn", _REAL, (3, 3)),
]
"""Once its level is solved: its miss, its ends, the roots of their limbs and its turn, which levels below leave so."""
TASK = np.dtype([*ASKED, *NOW, *REACH, *STIFFNESS, *EDGE, *KEPT], align=True)
