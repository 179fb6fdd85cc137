"""The records that kernels hand to each other, and what their fields are.

C constraints on a body of S segments and P points; N joints that a search may turn (``kernels.search.joints``), L
levels of priority, R rows of the Jacobian, Q constraints that keep arms clear, F frames. Kernels take a record packed,
as one address (``kernels.compiling``), and read its fields by name.
"""

from typing import Any, NamedTuple

import numpy as np

Array = Any
"""What numba hands on as an array: of floats where nothing else is said."""


class Pose(NamedTuple):
    """Where one frame of a body is."""

    positions: Array
    """(P, 3) metres."""
    rotations: Array
    """(S, 3, 3) in the world."""


class Limb(NamedTuple):
    """How one limb lies in its frame, whose z axis points from its root to its end."""

    bones: tuple[float, float]
    """Metres, upper and lower."""
    reach: float
    """Metres from its root to its end."""
    off_plane: float
    """Metres by which elbow or knee is to lie off the plane, along x."""
    bend: float
    """Sign of the side, along y, to which it bends."""
    twists: tuple[float, float]
    """Radians by which both bones turn about themselves."""


class Motion(NamedTuple):
    """All frames: ``start`` as they were before any constraint, and as they are solved."""

    start_positions: Array
    """(F, P, 3) metres."""
    start_rotations: Array
    """(F, S, 3, 3) in the world."""
    positions: Array
    rotations: Array


class Chain(NamedTuple):
    """Which joints a search may turn, and how freely each task moves them."""

    mobilities: Array
    """(C + L, N) of each task, and after them of each level any down to it."""
    joints: Array
    """(N,) records of ``JOINT``."""
    slots: Array
    """(S + 1,) the joint of each segment, of the root last; -1 none."""
    limits: Array
    """(N,) how far each may turn."""


class Legs(NamedTuple):
    """How legs stand, at one frame or at each of F."""

    channels: Array
    """(n,) or (F, n) of the motion (``kernels.layout``)."""
    comforts: Array
    """(2,) or (2, F) part of its length to which each leg stretches freely."""
    ankles: Array
    """(2, 3) or (2, F, 3) metres."""
    feet: Array
    """(2, 3, 3) or (2, F, 3, 3) in the world."""
    toes: Array
    """The same."""


class Arms(NamedTuple):
    """How arms stand, at each of F frames."""

    channels: Array
    """(F, n) of the motion (``kernels.layout``)."""
    comforts: Array
    """(2, F) part of its length to which each arm stretches freely, 0 where it is left alone."""
    wrists: Array
    """(2, F, 3) metres."""
    hands: Array
    """(2, F, 3, 3) in the world."""
    bends: Array
    """(2, F) sign of the side to which the elbow bends."""


class Links(NamedTuple):
    """N limbs that carry a body, as links between it and what stands."""

    starts: Array
    """(N, F, 3) metres from the root: hips, shoulders."""
    ends: Array
    """(N, F, 3) in the world: knees, ankles, wrists."""
    least: Array
    most: Array
    """(N, F) metres that each may be long."""


class BodyFrames(NamedTuple):
    """One body over all frames."""

    measures: Array
    """(F or 1, n) of ``kernels.layout``."""
    masses: Array
    """(S, 2) of ``kernels.tasks.balance``."""
    root_reaches: Array
    """(2, F) as ``Body`` has them."""
    legs: Legs
    limits: Array
    """(4,) of ``kernels.limits.joint_limits``, none where limbs have no limits."""
    shares: Array
    """(P,) of ``kernels.tasks.balance``."""


class Body(NamedTuple):
    """One body at one frame."""

    measures: Array
    """(n,) of ``kernels.layout``."""
    masses: Array
    """(S, 2) of ``kernels.tasks.balance``."""
    root_reaches: Array
    """(2,) parts of their lengths to which the root may stretch the legs, inf where a foot is free."""
    legs: Legs
    limits: Array
    """(4,) of ``kernels.limits.joint_limits``."""
    shares: Array
    """(P,) of ``kernels.tasks.balance``."""


class Recruits(NamedTuple):
    """The joints of limbs that a balance may turn."""

    joints: Array
    """(n,) which they are."""
    usual: Array
    """(C + L + 1, n) their mobilities, limits last."""
    free: Array
    """(L, n, F) how free each is for each level."""


class Targets(NamedTuple):
    """Where things are to be at full activation."""

    places: Array
    """(C, F or 1, 3) metres."""
    turns: Array
    """(C, F or 1, 3, 3)."""
    distances: Array
    """(C, F or 1) metres."""


class TaskRows(NamedTuple):
    """The rows of a step: first those that are held, then those that ask."""

    jacobian: Array
    """(R, N, 3) how each joint moves what each row measures."""
    errors: Array
    """(R,) by how much that is to move, metres."""
    owners: Array
    """(R,) the row of the mobilities by which each moves joints."""
    roles: Array
    """(R,) whether it is held, asks, or is a bound (``kernels.tasks.second_order``)."""
    brakes: Array
    """(N,) records of ``BRAKE``."""
    pulls: Array
    """(R,) records of ``PULL``."""
    rooms: Array
    """(R,) metres that a bound has to spare."""


class FlatRows(NamedTuple):
    """The same numbers with those of all joints in one line."""

    jacobian: Array
    """(R, 3 N) that of ``TaskRows``."""
    weighted: Array
    """(R, 3 N) times the mobilities of its owner."""
    steps: Array
    """(R + 2, 3 N) those of ``Equations``."""


class Equations(NamedTuple):
    """What ``kernels.search.priorities`` solves for one step."""

    gram: Array
    """(R, R) M, every row of the Jacobian times every weighted one."""
    held: Array
    """(R, R + 2) M_hh^-1 [e_h | M_ha], METHOD (21)."""
    normal: Array
    """(R, R + 1) the normal equations among the rows that ask, METHOD (23)."""
    active: Array
    """(R,) the active set: False for bounds that are not broken."""
    answer: Array
    """(R,) how far to go along the step of each row."""
    steps: Array
    """(R + 2, N, 3) the null-space projected step of each row, then that of all that is held, and of all that asks."""
    levers: Array
    """(R, R + 12) scratch."""
    flat: FlatRows


class DampedStep(NamedTuple):
    """Scratch of ``kernels.search.all_joints``, with D = 3 N."""

    system: Array
    """(D, D + 1)."""
    mobilities: Array
    """(D,)."""
    step: Array
    """(D,)."""
    levers: Array
    """(N, 3)."""


class Search(NamedTuple):
    """The state of the search of one frame, and its scratch."""

    rows: TaskRows
    equations: Equations
    damped: DampedStep
    last: Array
    """(1,) records of ``LAST_STEP``."""
    retreat: Array
    """(1,) records of ``search.retreat.RETREAT``."""
    carried: Array
    """(S + 1, 3, 3) how far each segment has turned away from the motion, nothing last."""
    state: Array
    """(N, 3) of ``kernels.search.joints``: how each joint has turned away from the motion."""
    before: Array
    """(N, 3) the state where the level began, or that is blended with the one that is kept."""
    kept: Array
    """(N, 3) the state of the pose that a frame on an edge is blended with."""
    tried: Array
    """(N, 3) the state where what was tried led."""
    ends: Array
    """(4,) the task that holds the end of each limb, -1 none."""
    blended: Array
    """(4,) whether a limb stays as it is blended (``kernels.time.activation_blend``)."""
    idle: Array
    """(4,) whether nothing asks anything of a limb."""
    sums: Array
    """(S + 1, 4) of ``kernels.tasks.balance``."""
    limbs: Array
    """(4,) records of ``LIMB_STATE``."""
    blended_turns: Array
    """(16, 3, 3) how each segment of a blended limb turns in what carries it, four a limb."""
    solved_turns: Array
    """(16, 3, 3) the same of the pose just solved."""
    kept_turns: Array
    """(16, 3, 3) the same of the pose that is kept."""


class Problem(NamedTuple):
    """One frame: what is asked, of what body, from which pose."""

    tasks: Array
    """(C,) records of ``kernels.tasks.task``, in order of rank."""
    areas: Array
    """(C, n) of ``kernels.tasks.areas``."""
    chain: Chain
    body: Body
    search: Search
    start: Pose
    """The motion's own."""
    pose: Pose
    """The one that is solved."""


class Asked(NamedTuple):
    """What is asked of all frames."""

    tasks: Array
    """(C,) records of ``kernels.tasks.task``, in order of rank."""
    areas: Array
    """(C, n) of ``kernels.tasks.areas``."""
    chain: Chain
    recruits: Recruits
    targets: Targets
    activations: Array
    """(K, C, F) of all down to each of K tiers of ``kernels.limits.clearance_tiers``, the last of all."""


class Volume(NamedTuple):
    """What a body fills: N capsules (``core.volume.BodyVolume``)."""

    segments: Array
    """(N, 2) on which each end lies."""
    places: Array
    """(N, 2, 3) in their axes."""
    radii: Array
    """(N, 2) metres."""
    girths: Array
    """(5,) of the probes of an arm."""


class ActorRooms(NamedTuple):
    """What the actor has of room, beside a body's volume: all of a ``Clearance`` that ``clear_arm`` needs."""

    volume: Volume
    rooms: Array
    """(F, 2, 5) metres."""
    ways: Array
    """(F, 2, 5, 3) out of the actor's body."""


class Clearance(NamedTuple):
    """What is to keep arms clear of their own body: Q constraints, the highest last."""

    volume: Volume
    proximal: Array
    """(S,) the point where each segment begins."""
    wanted: Array
    """(Q, F, 2, 5) metres of room that each probe is to have."""
    activations: Array
    """(Q, F)."""
    arms: Array
    """(Q, 2) 1 where an arm is meant."""
    freedoms: Array
    """(Q,) of the wrist."""
    above: Array
    """(Q, C) how constraints stand to each (``kernels.limits.clearing``)."""
    misses: Array
    """(Q, F) metres, written by kernels."""
    rooms: Array
    """(F, 2, 5) metres of room that the actor has."""
    ways: Array
    """(F, 2, 5, 3) out of the actor's body."""
    tiers: Array
    """(Q + C,) of them and of the constraints (``kernels.limits.clearance_tiers``)."""


class Clearing(NamedTuple):
    """Scratch of what keeps arms clear."""

    capsules: Array
    """(N,) records of ``CAPSULE``."""
    rooms: Array
    """(2, 5) metres of room of each probe now."""
    before: Array
    """(2, 5) the same before the constraints."""
    saved: Pose
    """(4, 3) points and (3, 3, 3) rotations of an arm."""
    turn: Array
    """(3, 3)."""
    held: Array
    """(3,) how far constraints above hold wrist, hand and swivel."""
    asks: Array
    """(5,) metres of room that the probes of an arm are to have now."""
    ways: Array
    """(5, 3) out of the body."""


class KeptTier(NamedTuple):
    """What has come to be of the tiers above one (``kernels.limits.clearance_tiers``)."""

    state: Array
    """(N, 3) of the search."""
    turns: Array
    """(16, 3, 3) of the limbs' segments in what carries each, four a limb."""
    first: Array
    """(C + Q,) what each misses, as it is kept."""
    own: Array
    """(C + Q,) the same when its own tier was kept."""
    now: Array
    """(C + Q,) the same of what has just been solved."""


class Above(NamedTuple):
    """What the levels above one have become, at all frames."""

    positions: Array
    """(F, P, 3)."""
    rotations: Array
    """(F, S, 3, 3)."""
    states: Array
    """(F, N, 3)."""
    back: Array
    """(F,) how far frames go back to that."""


class Easing(NamedTuple):
    """What is to be solved, or posed again as it was eased in time (``kernels.time.easing``)."""

    frames: Array
    """(n,) to be solved."""
    states: Array
    """(F, N, 3) of their searches."""
    turns: Array
    """(F, 16, 3, 3) of the limbs' joints, four a limb, as eased; none while nothing is."""
    level: Array
    """(1,) record of ``EASED_LEVEL``."""
    misses: Array
    """(C + Q, F) of those above as eased, and of others before."""
    above: Above
    limbs: Array
    """(4,) which limbs constraints are about."""
    peak: Array
    """(1,) the greatest angular acceleration of any joint in the unsolved motion, radians a second squared."""
    rate: Array
    """(1,) frames a second."""
    jolts: Array
    """(F, 3) of ``kernels.time.jolts``."""
    changes: Array
    """(F,) by how much easing changes what those above miss, metres or radians."""


class Clip(NamedTuple):
    """All that kernels know of all frames, with their scratch."""

    asked: Asked
    body: BodyFrames
    motion: Motion
    clearance: Clearance
    clearing: Clearing
    kept: KeptTier
    easing: Easing
    residuals: Array
    """(C, F) by how much each constraint is missed, written by kernels: metres or radians, NaN where not active."""


class Scratch(NamedTuple):
    """What is made once for all frames."""

    search: Search
    clearing: Clearing
    kept: KeptTier


JOINT = np.dtype([(name, np.int64) for name in ("segment", "pivot", "first", "past", "carrier")], align=True)
"""A joint that a search may turn: the segment it turns (-1 for the root's translation), the point about which, the
first and past the last of the segments that turn with it, and the segment that carries it (S none).
"""
LIMB_STATE = np.dtype(
    [
        *((name, np.int64) for name in ("limited", "holds_end", "turns_end", "taken", "primary", "primary_end")),
        ("primary_point", np.float64, (3,)),
        *((name, np.int64) for name in ("aims_upper", "swivels", "turns_lower")),
    ],
    align=True,
)
"""A limb while its tasks are solved (``kernels.limbs.limb_tasks``): whether joint limits bound it; whether hand or foot
keeps its orientation in the world, and whether a task asks for that; how many of its freedoms are taken (aim and bend,
then the swivel); its primary task, the end of that, and where it has brought its point; whether that is a point of the
upper segment, and whether it leaves a swivel; whether the lower segment was turned for itself.
"""
CAPSULE = np.dtype(
    [
        ("begin", np.float64, (3,)),
        ("axis", np.float64, (3,)),
        ("per_squared_length", np.float64),
        ("radius", np.float64),
        ("widens", np.float64),
    ],
    align=True,
)
"""A capsule in the world: where it begins and the way from there to its end, in metres, 1 / length^2, the radius where
it begins, and by how much that is more where it ends.
"""
BRAKE = np.dtype([("axis", np.float64, (3,)), ("part", np.float64)], align=True)
"""The world axis of a joint's turn, and the root of the part of its mobility that is left about it."""
PULL = np.dtype(
    [
        ("error", np.float64, (3,)),
        ("span", np.float64),
        ("point", np.float64, (3,)),
        ("weight", np.float64),
        ("carrier", np.int64),
    ],
    align=True,
)
"""What the second derivatives of a row come from (``kernels.tasks.second_order``): an error in metres, of a point of
the segment
``carrier`` (-1 none), or of a limb of length ``span`` from there; how much it counts.
"""
LAST_STEP = np.dtype([("missed", np.float64), ("suffices", np.int64)], align=True)
"""Of the last step of a search: what it missed, and whether it will do."""
EASED_LEVEL = np.dtype(
    [(name, np.int64) for name in ("rank", "meets", "contacts", "strict", "clears")],
    align=True,
)
"""The level that is eased: its rank; whether it is met again; how many ranks are contacts; whether frames that change
what stands above go back to that; how many that keep clear do not stand above it.
"""
