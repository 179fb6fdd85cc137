"""The tasks of the solver: one record a constraint, with room for what it wants at the frame being solved.

For all frames: ``kind`` (``kernels.tasks.goals``); ``rank``, its priority level; ``points``, ``segments`` and
``limbs`` (2,) of its two ends: the point of the body (-1 for an end that is none), the segment that it moves with, and
the limb (-1 none); ``offsets`` (2, 3) from those points; ``freedoms`` (2, 2) of limb and end segment; the second end
of all but a distance is what it follows on its own body, ``relative`` (3, 3) its turn in that segment's axes;
``blends`` whether its edges blend what is solved (``kernels.time.activation_blend``); ``weight`` among its equals;
``shares`` (2,) of each end in a distance;
``axes`` 3 when balance counts heights too.
For one frame: ``share`` its activation; what it ``counts`` beside the heaviest of its level; its ``status``, and
whether it is ``pinned`` to what it has (of a place that follows the own body ``relative`` is then where it is, in that
segment's axes); ``second`` whether another wish stands before it on its limb; ``engaged`` whether an area is entered;
``places`` (2, 3), ``turn`` (3, 3) and ``distance`` where things are to be, ``begin`` (3,) where the unsolved pose has
the centre of mass; ``helped`` whether joints beside its limbs may move; ``longest`` and ``folds`` (2,) metres that its
limbs can span, ``comforts`` (2,) the part of that which they take freely, ``reaches`` (2,) the metres which they are to
take, the chain doing the rest but for ``slack`` (2,) metres, ``easings`` (2,) the metres below which they fold ever
less.
``stiff`` whether upper or lower segment of a limb are, with ``parts``, ``change``, ``most`` (2, 2) and ``own`` (2,) of
``kernels.limbs.stiffness``.
On edges (``kernels.time.activation_blend``): its miss ``blended``, and how far ``apart`` what both poses miss is.
Once its level is solved: ``kept_miss``, ``kept_places`` (2, 3), ``kept_roots`` (2, 3) of its limbs and ``kept_turn``
(3, 3) are what the levels below have to leave as they are.
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

TASK = np.dtype(
    [
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
        ("share", _REAL),
        ("counts", _REAL),
        ("status", _FLAG),
        ("second", _FLAG),
        ("engaged", _FLAG),
        ("pinned", _FLAG),
        ("places", _REAL, (2, 3)),
        ("begin", _REAL, (3,)),
        ("turn", _REAL, (3, 3)),
        ("distance", _REAL),
        ("helped", _FLAG),
        ("longest", _REAL, (2,)),
        ("comforts", _REAL, (2,)),
        ("reaches", _REAL, (2,)),
        ("slack", _REAL, (2,)),
        ("origins", _REAL, (2, 3)),
        ("folds", _REAL, (2,)),
        ("easings", _REAL, (2,)),
        ("stiff", _FLAG),
        ("parts", _REAL, (2, 2)),
        ("change", _REAL, (2, 2)),
        ("most", _REAL, (2, 2)),
        ("own", _REAL, (2,)),
        ("blended", _REAL),
        ("apart", _REAL),
        ("kept_miss", _REAL),
        ("kept_places", _REAL, (2, 3)),
        ("kept_roots", _REAL, (2, 3)),
        ("kept_turn", _REAL, (3, 3)),
    ],
    align=True,
)
