"""Records of arrays that kernels pass to each other, and their fields.

C constraints on a body of S segments and P points; N joints in the search (``kernels.search.joints``), L levels of
priority, R rows of the Jacobian, Q self-collision constraints, F frames. A kernel receives a record packed, as one
address (``kernels.compiling``), and reads its fields by name. A level is a group of tasks of one priority, 0 the
highest.
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
    """Distance in metres from its root to its end."""
    off_plane: float
    """Offset in metres of elbow or knee along x, out of the plane in which the limb bends."""
    bend: float
    """Sign of y on the side to which elbow or knee bends."""
    twists: tuple[float, float]
    """Rotations in radians of upper and lower bone about themselves."""


class MotionArrays(NamedTuple):
    """Poses of all frames: the unsolved ones (``start``) and the solved ones."""

    start_positions: Array
    """(F, P, 3) metres."""
    start_rotations: Array
    """(F, S, 3, 3) in the world."""
    positions: Array
    """(F, P, 3) metres, solved."""
    rotations: Array
    """(F, S, 3, 3) in the world, solved."""


class JointWeights(NamedTuple):
    """Joints of the search, and their weights (the diagonal of the inverse metric) for each task."""

    weights: Array
    """(C + L, N) joint weights of each task, then of each level together with all levels above it."""
    joints: Array
    """(N,) records of ``SEARCH_JOINT``."""
    joint_of_segment: Array
    """(S + 1,) index of the joint of each segment, then that of the root's translation; -1 for none."""
    limits: Array
    """(N,) greatest length of each joint's Gibbs vector, the tangent of half the greatest angle."""


class LegTargets(NamedTuple):
    """Targets of both legs, at one frame or at each of F frames."""

    channels: Array
    """(n,) or (F, n) of the motion."""
    soft_thresholds: Array
    """(2,) or (2, F) soft-IK thresholds: the fraction of its length up to which each leg extends freely."""
    ankles: Array
    """(2, 3) or (2, F, 3) metres."""
    feet: Array
    """(2, 3, 3) or (2, F, 3, 3) in the world."""
    toes: Array
    """(2, 3, 3) or (2, F, 3, 3) in the world."""


class ArmTargets(NamedTuple):
    """Targets of both arms, at each of F frames."""

    channels: Array
    """(F, n) of the motion."""
    soft_thresholds: Array
    """(2, F) soft-IK thresholds: the fraction of its length up to which each arm extends freely, 0 for an arm without
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
    """(N, F, 3) hips or shoulders, metres from the root."""
    ends: Array
    """(N, F, 3) knees, ankles or wrists, in the world."""
    min_lengths: Array
    """(N, F) least length in metres."""
    max_lengths: Array
    """(N, F) greatest length in metres."""


class BodyFrames(NamedTuple):
    """One body over all frames."""

    measures: Array
    """(F or 1, n) measures of the body."""
    masses: Array
    """(S, 2) fraction of the body's mass, and position of the centre of mass along the segment."""
    root_reaches: Array
    """(2, F) extension, in leg lengths, to which the root may stretch each leg; inf for a free foot."""
    legs: LegTargets
    limits: Array
    """(4,) records ``LIMB_LIMITS``, empty without limits."""
    mass_fractions: Array
    """(P,) mass fractions of points that give the same centre of mass."""
    hand_contacts: Array
    """(2, F) records of ``HAND_CONTACT``, or (2, 1) without contacts."""
    ground: Array
    """(4, F or 1, 3) plane z = a + b x + c y of the ground under the unsolved end of each limb, metres."""


class FrameBody(NamedTuple):
    """One body at one frame."""

    measures: Array
    """(n,) measures of the body."""
    masses: Array
    """(S, 2) fraction of the body's mass, and position of the centre of mass along the segment."""
    root_reaches: Array
    """(2,) extension, in leg lengths, to which the root may stretch each leg; inf for a free foot."""
    legs: LegTargets
    limits: Array
    """(4,) records ``LIMB_LIMITS``, empty without limits."""
    mass_fractions: Array
    """(P,) mass fractions of points that give the same centre of mass."""
    hand_contacts: Array
    """(2,) records of ``HAND_CONTACT``."""
    ground: Array
    """(4, 3) plane z = a + b x + c y of the ground under the unsolved end of each limb, metres."""


class BalanceJoints(NamedTuple):
    """Shoulders and hips that may rotate to help a balance constraint."""

    joints: Array
    """(n,) indices among the joints of the search."""
    nominal_weights: Array
    """(C + L + 1, n) joint weights at full availability, of tasks, then levels, and their joint limits last."""
    availability: Array
    """(L, n, F) availability of each joint to each level, 0 to 1."""


class TargetArrays(NamedTuple):
    """Targets of all tasks at full activation."""

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
    """(R,) row of the joint weights by which each Jacobian row moves joints."""
    roles: Array
    """(R,) objective, equality or inequality (``kernels.tasks.second_order``)."""
    damping: Array
    """(N,) records of ``JOINT_DAMPING``."""
    point_errors: Array
    """(R,) records of ``POINT_ERROR``."""
    margins: Array
    """(R,) braking margin of each inequality, metres."""


class FlattenedTaskRows(NamedTuple):
    """Flat views (R, 3 N) of arrays of ``TaskRows`` and ``Equations``, which share memory: a row for each of the R task
    rows, three columns for each of the N joints.
    """

    jacobian: Array
    """(R, 3 N) ``TaskRows.jacobian``."""
    weighted: Array
    """(R, 3 N) Jacobian times joint weights."""
    directions: Array
    """(R + 2, 3 N) ``Equations.directions``."""


class Equations(NamedTuple):
    """Linear systems of ``kernels.search.null_space_step`` for one step."""

    gram: Array
    """(R, R) Gram matrix M of the Jacobian rows with the weighted rows."""
    equalities: Array
    """(R, R + 2) M_hh^-1 [e_h | M_ha], METHOD (21)."""
    normal: Array
    """(R, R + 1) normal equations of the objective rows, METHOD (23)."""
    active: Array
    """(R,) active set: False for an inequality that the step does not violate."""
    coefficients: Array
    """(R,) coefficient of each row's direction in the step."""
    directions: Array
    """(R + 2, N, 3) null-space projected direction of each row, then the step of the equality rows, then that of the
    objective rows.
    """
    scratch: Array
    """(R, R + 12) scratch."""
    flat: FlattenedTaskRows


class FullNewtonScratch(NamedTuple):
    """Scratch of ``kernels.search.full_newton_step``, with D = 3 N."""

    system: Array
    """(D, D + 1) linear system."""
    weights: Array
    """(D,) weight of each unknown."""
    step: Array
    """(D,) solution, and scratch row."""
    lever_arms: Array
    """(N, 3) lever arms, and scratch vectors."""


class SearchState(NamedTuple):
    """State of the search at one frame, and its scratch."""

    rows: TaskRows
    equations: Equations
    damped: FullNewtonScratch
    last_step: Array
    """(1,) records of ``LAST_STEP``."""
    backtracking: Array
    """(1,) records of ``search.backtracking.BACKTRACKING``."""
    segment_rotations: Array
    """(S + 1, 3, 3) world rotation of each segment away from the motion, the identity last."""
    state: Array
    """(N, 3) displacement of each joint from the motion: Gibbs vectors, metres for the root."""
    level_start: Array
    """(N, 3) state at the start of the level; while poses are blended, that of the pose just solved."""
    kept_state: Array
    """(N, 3) state of the saved pose of a blend."""
    trial_state: Array
    """(N, 3) state saved while other steps are tried."""
    end_tasks: Array
    """(4,) index of the task that holds each limb's hand or foot, -1 for none."""
    blended_limbs: Array
    """(4,) nonzero for a limb that keeps its blended pose (``kernels.time.activation_blend``)."""
    idle_limbs: Array
    """(4,) nonzero for a limb without tasks, whose rotations may be posed later."""
    mass_sums: Array
    """(S + 1, 4) prefix sums of moments and masses (``accumulate_masses``)."""
    limbs: Array
    """(4,) records of ``LIMB_STATE``."""
    blended_rotations: Array
    """(16, 3, 3) rotations of the limbs' segments in their parents in the blended pose, four a limb."""
    solved_rotations: Array
    """(16, 3, 3) rotations of the limbs' segments in their parents in the pose just solved, four a limb."""
    kept_rotations: Array
    """(16, 3, 3) rotations of the limbs' segments in their parents in the saved pose, four a limb."""


class FrameProblem(NamedTuple):
    """Problem of one frame: tasks, body and pose."""

    tasks: Array
    """(C,) records of ``TASK``, in order of level."""
    areas: Array
    """(C, n) area of each task, in the columns of ``kernels.tasks.area_shapes``."""
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
    """(C,) records of ``TASK``, in order of level."""
    areas: Array
    """(C, n) area of each task, in the columns of ``kernels.tasks.area_shapes``."""
    chain: JointWeights
    redundancy: BalanceJoints
    targets: TargetArrays
    activations: Array
    """(K, C, F) activations of the tasks down to each of K priority tiers (``kernels.limits.clearance_tiers``), all
    tasks in the last.
    """
    weights: Array
    """(C, F or 1) weights among tasks of the same level."""


class CapsuleArrays(NamedTuple):
    """Volume of a body: N capsules (``core.volume.BodyVolume``)."""

    segments: Array
    """(N, 2) indices of the segments to which both ends are fixed."""
    places: Array
    """(N, 2, 3) positions of both ends in the axes of these segments."""
    radii: Array
    """(N, 2) radii at both ends, metres."""
    girths: Array
    """(5,) radii of the probes of an arm, metres."""


class ActorClearance(NamedTuple):
    """Volume of a body, and signed distances of the captured actor's arms from the actor's own body."""

    volume: CapsuleArrays
    actor_distances: Array
    """(F, 2, 5) signed distances of both arms' probes, metres."""
    actor_directions: Array
    """(F, 2, 5, 3) outward directions of the actor's body."""


class ClearanceArrays(NamedTuple):
    """Self-collision constraints of the arms: Q constraints, that of the highest priority last."""

    volume: CapsuleArrays
    proximal: Array
    """(S,) index of the point at which each segment begins."""
    required_distances: Array
    """(Q, F, 2, 5) signed distance required of each probe, metres."""
    activations: Array
    """(Q, F) activations of the constraints."""
    arms: Array
    """(Q, 2) 1 for an arm that is constrained."""
    freedoms: Array
    """(Q,) weight by which the wrist may move, 0 to 1."""
    above: Array
    """(Q, C) priority of each task relative to each constraint (``TASK_ABOVE`` ...)."""
    residuals: Array
    """(Q, F) penetrations in metres, written by kernels."""
    actor_distances: Array
    """(F, 2, 5) signed distances of the actor's probes, metres."""
    actor_directions: Array
    """(F, 2, 5, 3) outward directions of the actor's body."""
    tiers: Array
    """(Q + C,) priority tier of each constraint, then of each task (``kernels.limits.clearance_tiers``)."""


class ClearanceScratch(NamedTuple):
    """Scratch of the self-collision constraints."""

    capsules: Array
    """(N,) records of ``CAPSULE``."""
    distances: Array
    """(2, 5) present signed distance of each probe, metres."""
    distances_before: Array
    """(2, 5) signed distance of each probe before the tasks, metres."""
    saved: Pose
    """(4, 3) points and (3, 3, 3) rotations of an arm before it is moved."""
    rotation: Array
    """(3, 3)."""
    arm_holds: Array
    """(3,) fractions to which higher tasks hold wrist, hand and swivel."""
    required_distances: Array
    """(5,) present signed distances required of one arm's probes, metres."""
    directions: Array
    """(5, 3) outward directions of one arm's probes."""


class SavedTier(NamedTuple):
    """Result of the priority tiers above the one being solved (``kernels.limits.clearance_tiers``)."""

    state: Array
    """(N, 3) state of the search."""
    rotations: Array
    """(16, 3, 3) rotations of the limbs' segments in their parents, four a limb."""
    first_residuals: Array
    """(C + Q,) residuals of the saved pose."""
    own_residuals: Array
    """(C + Q,) residuals when the tier of each task or constraint was saved."""
    new_residuals: Array
    """(C + Q,) residuals of the pose just solved."""


class HigherLevelPoses(NamedTuple):
    """Final poses in all frames of the levels above the one being smoothed."""

    positions: Array
    """(F, P, 3) metres."""
    rotations: Array
    """(F, S, 3, 3) in the world."""
    states: Array
    """(F, N, 3) states of the search."""
    return_fractions: Array
    """(F,) fraction of the way back to these poses, 1 for a level that is dropped completely."""


class SmoothingRun(NamedTuple):
    """Frames to be solved, or to be posed again after smoothing in time (``kernels.time.smoothed_frames``)."""

    frames: Array
    """(n,) indices of the frames."""
    states: Array
    """(F, N, 3) states of the search: results of a solve, or smoothed ones."""
    rotations: Array
    """(F, 16, 3, 3) smoothed rotations of the limbs' joints in their parents, four a limb; empty without smoothing."""
    level: Array
    """(1,) record of ``SMOOTHED_LEVEL``."""
    residuals: Array
    """(C + Q, F) residuals: smoothed ones of the levels above, unsmoothed ones of the others."""
    above: HigherLevelPoses
    limbs: Array
    """(4,) 1 for a limb with constraints."""
    allowed_peak: Array
    """(1,) greatest angular acceleration of any joint in the unsolved motion, rad/s2."""
    rate: Array
    """(1,) frames a second."""
    peaks: Array
    """(F, N + 1) acceleration peaks (``kernels.time.acceleration_peaks``), rad/s2."""
    violations: Array
    """(F,) priority violation of the smoothing, metres or radians."""


class ClipProblem(NamedTuple):
    """Problem of all frames, with scratch and results."""

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
    """Scratch of the solver, allocated once for all frames."""

    search: SearchState
    clearing: ClearanceScratch
    kept: SavedTier


SEARCH_JOINT = np.dtype([(name, np.int64) for name in ("segment", "pivot", "first", "past", "parent")], align=True)
"""A joint of the search: its ``segment`` (-1 for the root's translation), the ``pivot`` point about which it rotates,
the ``first`` segment of its subtree and the one ``past`` the last, and its ``parent`` segment (S for none).
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
if hand or foot keeps its world orientation, ``end_has_task`` if a task sets that; number of ``freedoms_used`` by tasks
(first bend and aim, then the swivel); the ``primary`` task, the end ``primary_end`` of it that is on the limb, and the
position of its point; ``aims_upper`` if that point is on the upper segment, ``swivels`` if it leaves a swivel;
``lower_rotated`` if a task rotated the lower segment itself.
"""
HAND_CONTACT = np.dtype(
    [
        *((name, np.float64) for name in ("together", "resting")),
        *((name, np.int64) for name in ("segment", "origin")),
    ],
    align=True,
)
"""Contact of a hand (``kernels.limbs.touching_arms``): weights in [0, 1] of its contact with the other hand
(``together``) and with the body (``resting``); the ``segment`` of the body under it, and the point ``origin`` at which
that begins.
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
"""A capsule in the world: the position of its beginning and the vector to its end, in metres, 1 / length^2, the radius
at its beginning, and the change of radius to its end.
"""
JOINT_DAMPING = np.dtype([("axis", np.float64, (3,)), ("fraction", np.float64)], align=True)
"""Damping of a joint near its limit: world axis of its rotation, and the square root of the fraction of its weight that
is left about that axis.
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
"""Source of the second-order term of a row (``kernels.tasks.second_order``): an ``error`` in metres of a ``point`` of
``segment`` (-1 for none), or of a limb of length ``span`` that begins at the point, and its ``weight``.
"""
LAST_STEP = np.dtype([("residual", np.float64), ("suffices", np.int64)], align=True)
"""Last step of a search: its ``residual`` in metres, and ``suffices``, 1 if no further step is necessary."""
SMOOTHED_LEVEL = np.dtype(
    [(name, np.int64) for name in ("level", "solves_again", "contact_levels", "keeps_priority", "clear_count")],
    align=True,
)
"""The level being smoothed: its number; ``solves_again`` 1 if it is solved again; number of levels that are contacts;
``keeps_priority`` 1 if frames that violate higher levels return to these; ``clear_count``, the number of self-collision
constraints without a higher priority.
"""
