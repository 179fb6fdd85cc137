"""Record of a task: a constraint as the solver sees it, with its state at the frame being solved.

Fields of two have one value for each *end*: the end effector, and the other point of a distance, or the point of the
own body that the task follows.
"""

import numpy as np

PRIORITY_TOLERANCE = 2e-4
"""Greatest change, in metres or radians, of a task's residual by all lower levels (METHOD 9, "The law"). The tolerances
of tasks that are met, held or at rest are fractions of it.
"""

_FLAG, _REAL = np.int64, np.float64

TASK_REQUEST = [
    ("kind", _FLAG),  # kind of task (``kernels.tasks.goals``)
    ("level", _FLAG),  # number of its level, 0 the highest
    ("points", _FLAG, (2,)),  # point of the body at each end, -1 none
    ("segments", _FLAG, (2,)),  # segment to which each end is fixed
    ("limbs", _FLAG, (2,)),  # limb of each end, -1 none
    ("offsets", _REAL, (2, 3)),  # metres from the point, in the axes of the segment
    ("limb_weights", _REAL, (2, 2)),  # weights of the limb, and of hand or foot
    ("relative", _REAL, (3, 3)),  # target rotation in the followed segment; if pinned, an offset
    ("blends", _FLAG),  # 1 if its transitions blend solutions (``kernels.time.activation_blend``)
    ("end_fractions", _REAL, (2,)),  # each end's part of a distance's correction
    ("axes", _FLAG),  # 3 for a balance whose height counts, else 2
    ("assisted", _FLAG),  # 1 if joints beside its limbs may move
]
"""Fields of a task for all frames."""
TASK_FRAME = [
    ("activation", _REAL),  # 0 to 1
    ("weight", _REAL),  # weight among the tasks of its level
    ("relative_weight", _REAL),  # weight relative to the heaviest of its level
    ("status", _FLAG),  # ``task_status.ACTIVE`` ...
    ("pinned", _FLAG),  # ``task_status.UNPINNED`` ...
    ("secondary", _FLAG),  # 1 if an earlier position task moves its limb
    ("engaged", _FLAG),  # 1 if its point is in its area
    ("goal_positions", _REAL, (2, 3)),  # goal of each end, metres
    ("goal_rotation", _REAL, (3, 3)),  # goal of its segment, in the world
    ("goal_distance", _REAL),  # goal in metres of a distance; also lean or activation
    ("start_position", _REAL, (3,)),  # unsolved first point, or centre of mass
]
"""Fields of a task at one frame."""
TASK_REACH = [
    ("max_reach", _REAL, (2,)),  # greatest distance of the end from the limb's root
    ("min_reach", _REAL, (2,)),  # least distance of the end from the limb's root
    ("soft_thresholds", _REAL, (2,)),  # soft-IK threshold, a fraction of the greatest reach
    ("goal_reaches", _REAL, (2,)),  # agreed reach
    ("slack", _REAL, (2,)),  # shortage that the chain leaves; of a trunk's point, a fraction
    ("root_positions", _REAL, (2, 3)),  # of the limb when its level begins
    ("flexion_thresholds", _REAL, (2,)),  # distance below which the limb folds softly
]
"""Fields of a task about the reach of the limb at each end, in metres.

The agreed reach is the distance from the limb's root to the goal that the limb covers by itself; the joints of the
chain cover the rest.
"""
TASK_STIFFNESS = [
    ("stiff", _FLAG),  # 1 if any segment is stiff
    ("segment_weights", _REAL, (2, 2)),  # fraction of its free change that a segment makes
    ("free_change", _REAL, (2, 2)),  # change without stiffness, radians and metres
    ("max_change", _REAL, (2, 2)),  # greatest change, radians and metres
    ("own_reach", _REAL, (2,)),  # reach at the motion's own bend, metres
]
"""Fields of a task about the stiffness of upper and lower segment of the limb at each end
(``kernels.limbs.stiffness``).
"""
TASK_TRANSITION = [("blended_residual", _REAL), ("residual_change", _REAL)]
"""Fields of a task in an activation transition: blended residual of both poses, and their difference."""
TASK_RESULT = [
    ("kept_residual", _REAL),  # metres or radians
    ("kept_positions", _REAL, (2, 3)),  # of its ends, or of the centre of mass
    ("kept_roots", _REAL, (2, 3)),  # of the limbs of its ends
    ("kept_rotation", _REAL, (3, 3)),  # of its segment
]
"""Fields of a task with the result of its level, which lower levels keep."""
TASK = np.dtype([*TASK_REQUEST, *TASK_FRAME, *TASK_REACH, *TASK_STIFFNESS, *TASK_TRANSITION, *TASK_RESULT], align=True)
"""Record of a task, one for each constraint."""
