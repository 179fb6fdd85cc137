"""Trial calls that compile all kernels, or load them from the cache, in advance."""

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.joint_limits import limb_limit_records
from studio.core.body.morphology import Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.grounds.surface_mesh import SurfaceMesh
from studio.core.kernels import channel_columns as channel
from studio.core.kernels.records import SEARCH_JOINT
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.adapt import adapt, solve_constraints
from studio.core.solver.grounding.contact_blending import smooth_drops
from studio.core.solver.grounding.footing import Footing
from studio.core.solver.grounding.grounded_motion import GroundedMotion, grounded_motion_of
from studio.core.solver.grounding.pelvis_tilt import tilt_pelvis_to_feet
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.smoothing.level_smoothing import SolveNotes
from studio.core.solver.smoothing.limb_coordinates import LimbCoordinates
from studio.core.solver.solved_window import ALL_LIMITS, SolvedWindow
from studio.core.solver.task_assembly.area_rows import nearest_allowed_position
from studio.core.solver.task_assembly.contact_release import constraint_activations

WARM_UP_FRAMES = 4
WARM_UP_POINT = BodyPoint(BodyPart.LEFT_HAND)
WARM_UP_ACTIVATION = ActivationCurve(0.0, 0.0, 1.0, 1.0)
WARM_UP_MESH = TriangleMesh(np.array(((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1))), np.array([[0, 1, 2]]))
"""Mesh of one triangle for trial calls, positions in metres."""


def warm_up(morphology: Morphology) -> AdaptedMotion:
    """Adapt four still frames to ``morphology`` with a contact and a constraint, to compile the kernels of most
    scenes.
    """
    contact = ContactInterval("warm-up", ContactPoint.LEFT_TOE, 0, WARM_UP_FRAMES - 1)
    warm_up_easing(morphology)
    return adapt(AdaptRequest(_still_motion(), morphology, (contact,), (_reach(),)))


def warm_up_grounded_motion(morphology: Morphology) -> GroundedMotion:
    """Ground four still frames, to compile the kernels used before constraints, a third of ``warm_up``."""
    return grounded_motion_of(AdaptRequest(_still_motion(), morphology))


def warm_up_easing(morphology: Morphology) -> None:
    """Call the kernels of smoothing on four still frames, to compile them."""
    charts = LimbCoordinates(
        morphology.layout, np.stack([rest_pose(morphology)[1]] * WARM_UP_FRAMES), limb_limit_records(morphology)
    )
    turns = charts.rotations(charts.clamped_to_limits(np.zeros((WARM_UP_FRAMES, 16, 3))))
    joints, states = np.zeros(1, SEARCH_JOINT), np.zeros((WARM_UP_FRAMES, 1, 3))
    ends = np.zeros((1, 2), np.int64)
    SolveNotes.of(_placed(morphology), WARM_UP_FRAMES, joints, ends, 0).peaks_of(states, turns)


def warm_up_constraints(morphology: Morphology) -> AdaptedMotion:
    """Solve constraints on four still frames, to compile the kernels of the search."""
    return solve_constraints(_placed(morphology), (_reach(),))


def _placed(morphology: Morphology) -> GroundedMotion:
    """Grounded motion of four still frames."""
    positions, rotations = (np.stack([each] * WARM_UP_FRAMES) for each in rest_pose(morphology))
    turns = np.broadcast_to(np.eye(3), (2, WARM_UP_FRAMES, 3, 3))
    states, fractions, ankles = (
        np.zeros((2, WARM_UP_FRAMES), np.int64),
        np.full((2, WARM_UP_FRAMES), 0.9),
        np.zeros((2, WARM_UP_FRAMES, 3)),
    )
    footing = Footing(states, fractions, np.full((2, WARM_UP_FRAMES), np.inf), ankles, turns, turns, fractions[0])
    return GroundedMotion(_still_motion(), morphology, (), Ground(), footing, (), None, positions, rotations)


def warm_up_support(morphology: Morphology) -> GroundedMotion:
    """Ground four still frames with hands, knees and seat in contact, hand contacts, and feet out of reach, to compile
    those kernels.
    """
    points = ContactPoint.LEFT_TOE, ContactPoint.LEFT_HAND, ContactPoint.LEFT_KNEE, ContactPoint.SEAT
    touches = Touch.HANDS_TOGETHER, Touch.LEFT_HAND_ON_TRUNK
    contacts = tuple(ContactInterval("warm-up", point, 1, 2) for point in (*points, *touches))
    ground = SurfaceMesh(vertices=WARM_UP_MESH.vertices, triangles=WARM_UP_MESH.triangles)
    smooth_drops(np.full(WARM_UP_FRAMES, 0.1), 30.0)
    pose = (np.stack([each] * WARM_UP_FRAMES) for each in rest_pose(morphology))
    tilt_pelvis_to_feet(
        np.zeros((2, WARM_UP_FRAMES, 3)), np.ones((2, WARM_UP_FRAMES), np.int64), morphology, 30.0, *pose
    )
    return grounded_motion_of(
        AdaptRequest(_still_motion(), morphology, contacts, (), ground, actor=morphology, clears=True)
    )


def warm_up_seldom(morphology: Morphology) -> None:
    """Pack rare kinds of constraint, self-collision and mesh areas, to compile their kernels."""
    what = "warm-up", "", WARM_UP_POINT, Chain(), 0, WARM_UP_ACTIVATION
    asked = ClearConstraint(*what), AreaConstraint(*what, shape=AreaShape.MESH, mesh=WARM_UP_MESH)
    standing = warm_up_support(morphology)
    SolvedWindow(standing, asked, constraint_activations(asked, standing), {}, ALL_LIMITS, slice(0, WARM_UP_FRAMES))
    nearest_allowed_position(asked[1], np.zeros(3))  # the window draws it


def _still_motion() -> NormalizedMotion:
    """Normalised motion of four still frames."""
    channels = np.zeros((WARM_UP_FRAMES, channel.SPINE + 4))
    channels[:, channel.HIPS + 2] = 0.9
    for column in channel.QUATERNION_COLUMNS:
        channels[:, column + 3] = 1.0
    channels[:, channel.SPINE + 3] = 1.0
    channels[:, channel.LIMB_SLACK : channel.LIMB_SLACK + 4] = 0.05
    channels[:, channel.LIMB_BEND : channel.LIMB_BEND + 4] = 1.0
    return NormalizedMotion("warm-up", 30.0, channels, np.array([0.0, 1.0]))


def _reach() -> PositionConstraint:
    """Position constraint of a hand."""
    return PositionConstraint(
        "warm-up",
        "Reach",
        WARM_UP_POINT,
        Chain(trunk=1.0, root=1.0),
        0,
        WARM_UP_ACTIVATION,
        target=(1.0, 0.5, 1.0),
    )
