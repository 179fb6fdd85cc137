"""Tasks of the solver: one record of ``TASK`` a constraint, with its state at the frame being solved.

The fields come in groups: the request for all frames, the state at one frame, the reach of its limbs, their stiffness,
the state of a transition, and the result of its level. Fields of two have one value for each *end*: the end effector,
and the other point of a distance, or the point of the own body that the task follows. ``task_status`` has the values of
``status`` and of ``pinned``.
"""

import numpy as np

PRIORITY_TOLERANCE = 2e-4
"""Greatest change, in metres or radians, of a residual by all lower levels (METHOD 9, "The law"); the tolerances of
tasks that are met, held or at rest are fractions of it.
"""

_FLAG, _REAL = np.int64, np.float64

TASK_REQUEST = [
    ("kind", _FLAG),
    ("level", _FLAG),
    ("points", _FLAG, (2,)),
    ("segments", _FLAG, (2,)),
    ("limbs", _FLAG, (2,)),
    ("offsets", _REAL, (2, 3)),
    ("limb_weights", _REAL, (2, 2)),
    ("relative", _REAL, (3, 3)),
    ("blends", _FLAG),
    ("end_fractions", _REAL, (2,)),
    ("axes", _FLAG),
    ("assisted", _FLAG),
]
"""For all frames: its kind (``kernels.tasks.goals``) and level; of each end the point of the body (-1 none), its
segment, its limb (-1 none), the offset from the point, and the weights of limb and of hand or foot; ``relative``
rotation in the axes that it follows; ``blends`` if its transitions blend solutions (``kernels.time.activation_blend``);
``end_fractions`` of the ends in a distance; 3 ``axes`` where a balance counts heights too, else 2;
``assisted`` if joints beside its limbs may move.
"""
TASK_FRAME = [
    ("activation", _REAL),
    ("weight", _REAL),
    ("relative_weight", _REAL),
    ("status", _FLAG),
    ("pinned", _FLAG),
    ("secondary", _FLAG),
    ("engaged", _FLAG),
    ("goal_positions", _REAL, (2, 3)),
    ("goal_rotation", _REAL, (3, 3)),
    ("goal_distance", _REAL),
    ("start_position", _REAL, (3,)),
]
"""At one frame: its activation; its weight, also relative to the heaviest of its level; its status; pinned (then
``relative`` is the offset in the axes that it follows); ``secondary`` if its limb has another position task before it;
``engaged`` if its area is entered; the goal positions, rotation or distance; its first point, or the centre of mass, in
the unsolved pose.
"""
TASK_REACH = [
    ("max_reach", _REAL, (2,)),
    ("min_reach", _REAL, (2,)),
    ("soft_thresholds", _REAL, (2,)),
    ("goal_reaches", _REAL, (2,)),
    ("slack", _REAL, (2,)),
    ("root_positions", _REAL, (2, 3)),
    ("flexion_thresholds", _REAL, (2,)),
]
"""Reach of each limb: greatest and least in metres; soft-IK threshold; the agreed reach, beyond which the chain moves,
less the slack; the position of its root; the distance in metres below which it folds softly.
"""
TASK_STIFFNESS = [
    ("stiff", _FLAG),
    ("segment_weights", _REAL, (2, 2)),
    ("free_change", _REAL, (2, 2)),
    ("max_change", _REAL, (2, 2)),
    ("own_reach", _REAL, (2,)),
]
"""Stiffness of its limbs' upper and lower segments, see ``kernels.limbs.stiffness``."""
TASK_TRANSITION = [("blended_residual", _REAL), ("residual_change", _REAL)]
"""In transitions (``kernels.time.activation_blend``): blended residual of both poses, and their difference."""
TASK_RESULT = [
    ("kept_residual", _REAL),
    ("kept_positions", _REAL, (2, 3)),
    ("kept_roots", _REAL, (2, 3)),
    ("kept_rotation", _REAL, (3, 3)),
]
"""Result of its level, which lower levels keep: residual, positions of its ends, of their limbs' roots, and
rotation.
"""
TASK = np.dtype([*TASK_REQUEST, *TASK_FRAME, *TASK_REACH, *TASK_STIFFNESS, *TASK_TRANSITION, *TASK_RESULT], align=True)
