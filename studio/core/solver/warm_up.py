"""Compile every kernel, or fetch it from the cache, before anybody waits for it."""

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.joint_limits import limits_of
from studio.core.body.morphology import Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.grounds.surface_mesh import SurfaceMesh
from studio.core.kernels import layout as at
from studio.core.kernels.records import SEARCH_JOINT
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.adapt import adapt, hold
from studio.core.solver.asking.areas import nearest_place
from studio.core.solver.asking.releasing import constraint_activations
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.smoothing.easing import Solve
from studio.core.solver.smoothing.limb_charts import LimbCharts
from studio.core.solver.solved_window import BOUND, SolvedWindow
from studio.core.solver.standing.blends import smooth_drops
from studio.core.solver.standing.footing import Footing
from studio.core.solver.standing.obliquity import dip_pelvis
from studio.core.solver.standing.stand import Standing, standing_of

FRAMES = 4
HAND = BodyPoint(BodyPart.LEFT_HAND)
ALWAYS = ActivationCurve(0.0, 0.0, 1.0, 1.0)
TRIANGLE = TriangleMesh(np.array(((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1))), np.array([[0, 1, 2]]))
"""Metres: what kernels are tried on."""


def warm_up(morphology: Morphology) -> AdaptedMotion:
    """Adapt four still frames to ``morphology`` with a contact and a constraint: what most scenes call."""
    contact = ContactInterval("warm-up", ContactPoint.LEFT_TOE, 0, FRAMES - 1)
    warm_up_easing(morphology)
    return adapt(AdaptRequest(_still_motion(), morphology, (contact,), (_reach(),)))


def warm_up_standing(morphology: Morphology) -> Standing:
    """The third of ``warm_up`` that comes before the constraints."""
    return standing_of(AdaptRequest(_still_motion(), morphology))


def warm_up_easing(morphology: Morphology) -> None:
    """What only frames that jolt are given to."""
    charts = LimbCharts(morphology.layout, np.stack([rest_pose(morphology)[1]] * FRAMES), limits_of(morphology))
    turns = charts.turns(charts.within(np.zeros((FRAMES, 16, 3))))
    joints, states = np.zeros(1, SEARCH_JOINT), np.zeros((FRAMES, 1, 3))
    moved, ends = np.ones(len(joints), dtype=bool), np.zeros((1, 2), np.int64)
    Solve.of(_placed(morphology), FRAMES, joints, moved, ends, 0).jolts_of(states, turns)


def warm_up_constraints(morphology: Morphology) -> AdaptedMotion:
    """The rest of ``warm_up``."""
    return hold(_placed(morphology), (_reach(),))


def _placed(morphology: Morphology) -> Standing:
    """Four still frames that nobody had to set on the ground."""
    positions, rotations = (np.stack([each] * FRAMES) for each in rest_pose(morphology))
    turns = np.broadcast_to(np.eye(3), (2, FRAMES, 3, 3))
    states, shares, ankles = np.zeros((2, FRAMES), np.int64), np.full((2, FRAMES), 0.9), np.zeros((2, FRAMES, 3))
    footing = Footing(states, shares, np.full((2, FRAMES), np.inf), ankles, turns, turns, shares[0])
    return Standing(_still_motion(), morphology, (), Ground(), footing, (), None, positions, rotations)


def warm_up_support(morphology: Morphology) -> Standing:
    """What sets some bodies on the ground: hands, knees, seat that stand, hands that touch, feet out of reach."""
    points = ContactPoint.LEFT_TOE, ContactPoint.LEFT_HAND, ContactPoint.LEFT_KNEE, ContactPoint.SEAT
    touches = Touch.HANDS_TOGETHER, Touch.LEFT_HAND_ON_TRUNK
    contacts = tuple(ContactInterval("warm-up", point, 1, 2) for point in (*points, *touches))
    ground = SurfaceMesh(vertices=TRIANGLE.vertices, triangles=TRIANGLE.triangles)
    smooth_drops(np.full(FRAMES, 0.1), 30.0)
    pose = (np.stack([each] * FRAMES) for each in rest_pose(morphology))
    dip_pelvis(np.zeros((2, FRAMES, 3)), np.ones((2, FRAMES), np.int64), morphology, 30.0, *pose)
    return standing_of(AdaptRequest(_still_motion(), morphology, contacts, (), ground, actor=morphology, clears=True))


def warm_up_seldom(morphology: Morphology) -> None:
    """What only some constraints call: distances kept, and areas that are meshes."""
    what = "warm-up", "", HAND, Chain(), 0, ALWAYS
    asked = ClearConstraint(*what), AreaConstraint(*what, shape=AreaShape.MESH, mesh=TRIANGLE)
    standing = warm_up_support(morphology)
    SolvedWindow(standing, asked, constraint_activations(asked, standing), {}, BOUND, slice(0, FRAMES))
    nearest_place(asked[1], np.zeros(3))  # the window draws it


def _still_motion() -> NormalizedMotion:
    channels = np.zeros((FRAMES, at.SPINE + 4))
    channels[:, at.HIPS + 2] = 0.9
    for column in at.QUATERNION_COLUMNS:
        channels[:, column + 3] = 1.0
    channels[:, at.SPINE + 3] = 1.0
    channels[:, at.LIMB_SLACK : at.LIMB_SLACK + 4] = 0.05
    channels[:, at.LIMB_BEND : at.LIMB_BEND + 4] = 1.0
    return NormalizedMotion("warm-up", 30.0, channels, np.array([0.0, 1.0]))


def _reach() -> PositionConstraint:
    return PositionConstraint(
        "warm-up",
        "Reach",
        HAND,
        Chain(trunk=1.0, root=1.0),
        0,
        ALWAYS,
        target=(1.0, 0.5, 1.0),
    )
