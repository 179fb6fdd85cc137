"""Records of arrays that kernels pass to each other, and their fields.

C constraints on a body of S segments and P points; N joints in the search (``kernels.search.joints``), L levels of
priority, R rows of the Jacobian, Q self-collision constraints, F frames. A kernel receives a record packed, as one
address (``kernels.compiling``), and reads its fields by name.
"""

from typing import Any, NamedTuple

import numpy as np

Array = Any
"""Numba array; of floats unless another type is given."""


class Pose(NamedTuple):
    """One frame of a body."""

    positions: Array
    """(P, 3) metres."""
    rotations: Array
    """(S, 3, 3) in the world."""


class LimbShape(NamedTuple):
    """Shape of one limb in its frame, whose z axis points from its root to its end."""

    bones: tuple[float, float]
    """Metres, upper and lower."""
    reach: float
    """Metres from its root to its end."""
    off_plane: float
    """Offset in metres of elbow or knee from the plane, along x."""
    bend: float
    """Sign of the side, along y, to which it bends."""
    twists: tuple[float, float]
    """Rotations in radians of both bones about themselves."""


class MotionArrays(NamedTuple):
    """All frames: unsolved poses (``start``) and solved poses."""

    start_positions: Array
    """(F, P, 3) metres."""
    start_rotations: Array
    """(F, S, 3, 3) in the world."""
    positions: Array
    rotations: Array


class JointWeights(NamedTuple):
    """Joints of the search, and their weights (the diagonal of the inverse metric) for each task."""

    weights: Array
    """(C + L, N) of each task, then of each level with all above it."""
    joints: Array
    """(N,) records of ``SEARCH_JOINT``."""
    joint_of_segment: Array
    """(S + 1,) joint of each segment, of the root last; -1 none."""
    limits: Array
    """(N,) greatest length of each joint's Gibbs vector."""


class LegTargets(NamedTuple):
    """Leg targets, at one frame or at each of F."""

    channels: Array
    """(n,) or (F, n) of the motion (``kernels.layout``)."""
    soft_thresholds: Array
    """(2,) or (2, F) soft-IK thresholds: the fraction of its length to which each leg extends freely."""
    ankles: Array
    """(2, 3) or (2, F, 3) metres."""
    feet: Array
    """(2, 3, 3) or (2, F, 3, 3) in the world."""
    toes: Array
    """(2, 3, 3) or (2, F, 3, 3) in the world."""


class ArmTargets(NamedTuple):
    """Arm targets, at each of F frames."""

    channels: Array
    """(F, n) of the motion (``kernels.layout``)."""
    soft_thresholds: Array
    """(2, F) soft-IK thresholds: the fraction of its length to which each arm extends freely, 0 for an arm without
    target.
    """
    wrists: Array
    """(2, F, 3) metres."""
    hands: Array
    """(2, F, 3, 3) in the world."""
    bends: Array
    """(2, F) sign of the side to which the elbow bends."""


class SupportLinks(NamedTuple):
    """N supporting limbs as links between the body and their contacts."""

    starts: Array
    """(N, F, 3) metres from the root: hips, shoulders."""
    ends: Array
    """(N, F, 3) in the world: knees, ankles, wrists."""
    min_lengths: Array
    max_lengths: Array
    """(N, F) bounds of each length in metres."""


class BodyFrames(NamedTuple):
    """One body over all frames."""

    measures: Array
    """(F or 1, n) of ``kernels.layout``."""
    masses: Array
    """(S, 2) of ``kernels.tasks.balance``."""
    root_reaches: Array
    """(2, F) as in ``FrameBody``."""
    legs: LegTargets
    limits: Array
    """(4,) of ``kernels.limits.limb_joint_limits``, empty without limits."""
    mass_fractions: Array
    """(P,) of ``kernels.tasks.balance``."""
    hand_contacts: Array
    """(2, F) records of ``HAND_CONTACT``, or (2, 1) of none."""
    ground: Array
    """(4, F or 1, 3) as in ``FrameBody``."""


class FrameBody(NamedTuple):
    """One body at one frame."""

    measures: Array
    """(n,) of ``kernels.layout``."""
    masses: Array
    """(S, 2) of ``kernels.tasks.balance``."""
    root_reaches: Array
    """(2,) fractions of their lengths to which the root may stretch the legs, inf for a free foot."""
    legs: LegTargets
    limits: Array
    """(4,) of ``kernels.limits.limb_joint_limits``."""
    mass_fractions: Array
    """(P,) of ``kernels.tasks.balance``."""
    hand_contacts: Array
    """(2,) records of ``HAND_CONTACT``."""
    ground: Array
    """(4, 3) plane z = a + b x + c y of the ground under the unsolved end of each limb, metres."""


class BalanceJoints(NamedTuple):
    """Joints of limbs that may rotate to help a balance constraint."""

    joints: Array
    """(n,) indices of the joints."""
    nominal_weights: Array
    """(C + L + 1, n) their weights, limits last."""
    availability: Array
    """(L, n, F) fraction of each joint available to each level."""


class TargetArrays(NamedTuple):
    """Targets at full activation."""

    positions: Array
    """(C, F or 1, 3) metres."""
    rotations: Array
    """(C, F or 1, 3, 3)."""
    distances: Array
    """(C, F or 1) metres."""


class TaskRows(NamedTuple):
    """Rows of one step: equality and inequality rows of higher levels first, then objective rows."""

    jacobian: Array
    """(R, N, 3) derivative of each row by each joint."""
    errors: Array
    """(R,) error of each row, metres."""
    weight_rows: Array
    """(R,) row of the joint weights by which each moves joints."""
    roles: Array
    """(R,) objective, equality or inequality (``kernels.tasks.second_order``)."""
    damping: Array
    """(N,) records of ``JOINT_DAMPING``."""
    point_errors: Array
    """(R,) records of ``POINT_ERROR``."""
    margins: Array
    """(R,) margin of an inequality in metres."""


class FlattenedTaskRows(NamedTuple):
    """``TaskRows`` with the Jacobians of all joints in one row, (R, 3 N): the same memory."""

    jacobian: Array
    """(R, 3 N) that of ``TaskRows``."""
    weighted: Array
    """(R, 3 N) Jacobian times joint weights."""
    directions: Array
    """(R + 2, 3 N) those of ``Equations``."""


class Equations(NamedTuple):
    """Linear systems of ``kernels.search.null_space_step`` for one step."""

    gram: Array
    """(R, R) M, each row of the Jacobian times each weighted one."""
    equalities: Array
    """(R, R + 2) M_hh^-1 [e_h | M_ha], METHOD (21)."""
    normal: Array
    """(R, R + 1) normal equations of the objective rows, METHOD (23)."""
    active: Array
    """(R,) active set: False for an inequality that holds."""
    coefficients: Array
    """(R,) coefficient of the direction of each row."""
    directions: Array
    """(R + 2, N, 3) null-space projected direction of each row, then the step of the equalities, then that of the
    objectives.
    """
    scratch: Array
    """(R, R + 12) scratch."""
    flat: FlattenedTaskRows


class FullNewtonScratch(NamedTuple):
    """Scratch of ``kernels.search.full_newton_step``, with D = 3 N."""

    system: Array
    """(D, D + 1)."""
    weights: Array
    """(D,)."""
    step: Array
    """(D,)."""
    lever_arms: Array
    """(N, 3)."""


class SearchState(NamedTuple):
    """State of the search of one frame, and its scratch."""

    rows: TaskRows
    equations: Equations
    damped: FullNewtonScratch
    last_step: Array
    """(1,) records of ``LAST_STEP``."""
    backtracking: Array
    """(1,) records of ``search.backtracking.BACKTRACKING``."""
    segment_rotations: Array
    """(S + 1, 3, 3) rotation of each segment away from the motion, the identity last."""
    state: Array
    """(N, 3) of ``kernels.search.joints``: displacement of each joint from the motion."""
    level_start: Array
    """(N, 3) state at the start of the level, or of the pose just solved while poses are blended."""
    kept_state: Array
    """(N, 3) state of the saved pose of an activation transition."""
    trial_state: Array
    """(N, 3) state of a trial."""
    end_tasks: Array
    """(4,) task that holds the end of each limb, -1 none."""
    blended_limbs: Array
    """(4,) nonzero for a limb that keeps its blended pose (``kernels.time.activation_blend``)."""
    idle_limbs: Array
    """(4,) nonzero for a limb without tasks."""
    mass_sums: Array
    """(S + 1, 4) of ``kernels.tasks.balance``."""
    limbs: Array
    """(4,) records of ``LIMB_STATE``."""
    blended_rotations: Array
    """(16, 3, 3) rotation of each segment of a blended limb in its parent, four a limb."""
    solved_rotations: Array
    """(16, 3, 3) the same of the pose just solved."""
    kept_rotations: Array
    """(16, 3, 3) the same of the saved pose."""


class FrameProblem(NamedTuple):
    """Problem of one frame: tasks, body and pose."""

    tasks: Array
    """(C,) records of ``kernels.tasks.task``, in order of level."""
    areas: Array
    """(C, n) of ``kernels.tasks.area_shapes``."""
    chain: JointWeights
    body: FrameBody
    search: SearchState
    start: Pose
    """Unsolved pose."""
    pose: Pose
    """Pose being solved."""


class ConstraintSet(NamedTuple):
    """Tasks of all frames."""

    tasks: Array
    """(C,) records of ``kernels.tasks.task``, in order of level."""
    areas: Array
    """(C, n) of ``kernels.tasks.area_shapes``."""
    chain: JointWeights
    redundancy: BalanceJoints
    targets: TargetArrays
    activations: Array
    """(K, C, F) of the tasks down to each of K tiers of ``kernels.limits.clearance_tiers``, all tasks in the last."""
    weights: Array
    """(C, F or 1) among tasks of the same level."""


class CapsuleArrays(NamedTuple):
    """Volume of a body: N capsules (``core.volume.BodyVolume``)."""

    segments: Array
    """(N, 2) segments of both ends."""
    places: Array
    """(N, 2, 3) positions of the ends in these segments' axes."""
    radii: Array
    """(N, 2) metres."""
    girths: Array
    """(5,) radii of the probes of an arm."""


class ActorClearance(NamedTuple):
    """Signed distances of the actor's arms beside a body's volume: the part of ``ClearanceArrays`` that
    ``push_arm_out`` reads.
    """

    volume: CapsuleArrays
    actor_distances: Array
    """(F, 2, 5) metres."""
    actor_directions: Array
    """(F, 2, 5, 3) outward directions of the actor's body."""


class ClearanceArrays(NamedTuple):
    """Self-collision constraints of the arms: Q constraints, that of the highest priority last."""

    volume: CapsuleArrays
    proximal: Array
    """(S,) first point of each segment."""
    required_distances: Array
    """(Q, F, 2, 5) signed distance in metres required of each probe."""
    activations: Array
    """(Q, F)."""
    arms: Array
    """(Q, 2) 1 for an arm that is constrained."""
    freedoms: Array
    """(Q,) weight of the wrist."""
    above: Array
    """(Q, C) relation of each task to each constraint (``kernels.limits.self_collision``)."""
    residuals: Array
    """(Q, F) metres, written by kernels."""
    actor_distances: Array
    """(F, 2, 5) signed distances of the actor in metres."""
    actor_directions: Array
    """(F, 2, 5, 3) outward directions of the actor's body."""
    tiers: Array
    """(Q + C,) tier of each constraint and task (``kernels.limits.clearance_tiers``)."""


class ClearanceScratch(NamedTuple):
    """Scratch of the self-collision constraints."""

    capsules: Array
    """(N,) records of ``CAPSULE``."""
    distances: Array
    """(2, 5) signed distance of each probe now, metres."""
    distances_before: Array
    """(2, 5) the same before the tasks."""
    saved: Pose
    """(4, 3) points and (3, 3, 3) rotations of an arm."""
    rotation: Array
    """(3, 3)."""
    arm_holds: Array
    """(3,) fraction to which higher tasks hold wrist, hand and swivel."""
    required_distances: Array
    """(5,) signed distances required of the probes of one arm now, metres."""
    directions: Array
    """(5, 3) outward directions."""


class SavedTier(NamedTuple):
    """Result of the tiers above one (``kernels.limits.clearance_tiers``)."""

    state: Array
    """(N, 3) of the search."""
    rotations: Array
    """(16, 3, 3) of the limbs' segments in their parents, four a limb."""
    first_residuals: Array
    """(C + Q,) residuals of the saved pose."""
    own_residuals: Array
    """(C + Q,) residuals when each task's own tier was saved."""
    new_residuals: Array
    """(C + Q,) residuals of the pose just solved."""


class HigherLevelPoses(NamedTuple):
    """Final poses of the levels above the current one, in all frames."""

    positions: Array
    """(F, P, 3)."""
    rotations: Array
    """(F, S, 3, 3)."""
    states: Array
    """(F, N, 3)."""
    return_fractions: Array
    """(F,) fraction of the return to these poses."""


class SmoothingRun(NamedTuple):
    """Frames to be solved, or posed again after smoothing in time (``kernels.time.smoothed_frames``)."""

    frames: Array
    """(n,) to be solved."""
    states: Array
    """(F, N, 3) states of their searches."""
    rotations: Array
    """(F, 16, 3, 3) smoothed rotations of the limbs' joints, four a limb; empty without smoothing."""
    level: Array
    """(1,) record of ``SMOOTHED_LEVEL``."""
    residuals: Array
    """(C + Q, F) smoothed residuals of the levels above, unsmoothed ones of the others."""
    above: HigherLevelPoses
    limbs: Array
    """(4,) 1 for a limb with constraints."""
    allowed_peak: Array
    """(1,) greatest angular acceleration of any joint in the unsolved motion, rad/s2."""
    rate: Array
    """(1,) frames a second."""
    peaks: Array
    """(F, N + 1) of ``kernels.time.acceleration_peaks``."""
    violations: Array
    """(F,) priority violation of the smoothing, metres or radians."""


class ClipProblem(NamedTuple):
    """Problem of all frames, with scratch."""

    constraints: ConstraintSet
    body: BodyFrames
    motion: MotionArrays
    clearance: ClearanceArrays
    clearing: ClearanceScratch
    kept: SavedTier
    easing: SmoothingRun
    residuals: Array
    """(C, F) residual of each task, written by kernels: metres or radians, NaN where inactive."""


class SolverScratch(NamedTuple):
    """Scratch made once for all frames."""

    search: SearchState
    clearing: ClearanceScratch
    kept: SavedTier


SEARCH_JOINT = np.dtype([(name, np.int64) for name in ("segment", "pivot", "first", "past", "parent")], align=True)
"""A joint of the search: its segment (-1 for the root's translation), the point about which it rotates, the first and
past the last segment of its subtree, and its parent segment (S none).
"""
LIMB_STATE = np.dtype(
    [
        *(
            (name, np.int64)
            for name in ("has_limits", "holds_end", "end_has_task", "freedoms_used", "primary", "primary_end")
        ),
        ("primary_point", np.float64, (3,)),
        *((name, np.int64) for name in ("aims_upper", "swivels", "lower_rotated")),
    ],
    align=True,
)
"""A limb while its tasks are solved (``kernels.limbs.limb_tasks``): ``has_limits`` if joint limits apply; ``holds_end``
if hand or foot keeps its world orientation, ``end_has_task`` if a task sets it; ``freedoms_used`` by tasks (aim and
bend, then the swivel); the ``primary`` task, its end, and the position of its point; ``aims_upper`` if that is a point
of the upper segment, ``swivels`` if it leaves a swivel; ``lower_rotated`` if the lower segment was rotated for itself.
"""
HAND_CONTACT = np.dtype(
    [
        *((name, np.float64) for name in ("together", "resting")),
        *((name, np.int64) for name in ("segment", "origin")),
    ],
    align=True,
)
"""Contact of a hand (``kernels.limbs.touching_arms``): weights in [0, 1] of its contact with the other hand, and with
the body; the segment of the body under it, and the point where that begins.
"""
CAPSULE = np.dtype(
    [
        ("begin", np.float64, (3,)),
        ("axis", np.float64, (3,)),
        ("per_squared_length", np.float64),
        ("radius", np.float64),
        ("radius_change", np.float64),
    ],
    align=True,
)
"""A capsule in the world: where it begins and the vector to its end, in metres, 1 / length^2, the radius at its
beginning, and the radius change to its end.
"""
JOINT_DAMPING = np.dtype([("axis", np.float64, (3,)), ("fraction", np.float64)], align=True)
"""World axis of a joint's rotation, and the square root of the fraction of its weight that its limit leaves
about it.
"""
POINT_ERROR = np.dtype(
    [
        ("error", np.float64, (3,)),
        ("span", np.float64),
        ("point", np.float64, (3,)),
        ("weight", np.float64),
        ("segment", np.int64),
    ],
    align=True,
)
"""Source of the second-order term of a row (``kernels.tasks.second_order``): an error in metres of a point of
``segment`` (-1 none), or of a limb of length ``span`` from there, and its weight.
"""
LAST_STEP = np.dtype([("residual", np.float64), ("suffices", np.int64)], align=True)
"""Last step of a search: its residual, and 1 if that suffices."""
SMOOTHED_LEVEL = np.dtype(
    [(name, np.int64) for name in ("level", "solves_again", "contact_levels", "keeps_priority", "clear_count")],
    align=True,
)
"""The level being smoothed: its number; 1 if it is solved again; how many levels are contacts; 1 if frames that violate
higher levels return to these; how many self-collision constraints do not stand above it.
"""
