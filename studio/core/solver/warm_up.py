"""Compile every kernel, or fetch it from the cache, before anybody waits for it."""

import numpy as np

from studio.core.canonical import BodyPart
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.contacts import ContactInterval, ContactPoint
from studio.core.kernels import layout as at
from studio.core.morphology import Morphology
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest


def warm_up(morphology: Morphology) -> AdaptedMotion:
    """Adapt four still frames to ``morphology`` with a contact and a constraint: every kernel runs once."""
    channels = np.zeros((4, at.SPINE + 4))
    channels[:, at.HIPS + 2] = 0.9
    for column in at.TURNS:
        channels[:, column + 3] = 1.0
    channels[:, at.SPINE + 3] = 1.0
    channels[:, at.LIMB_SLACK : at.LIMB_SLACK + 4] = 0.05
    channels[:, at.LIMB_BEND : at.LIMB_BEND + 4] = 1.0
    motion = NormalizedMotion("warm-up", 30.0, channels, np.array([0.0, 1.0]))
    reach = PositionConstraint(
        "warm-up",
        "Reach",
        BodyPoint(BodyPart.LEFT_HAND),
        Chain(trunk=1.0, root=1.0),
        0,
        ActivationCurve(0.0, 0.0, 1.0, 1.0),
        target=(1.0, 0.5, 1.0),
    )
    contact = ContactInterval("warm-up", ContactPoint.LEFT_TOE, 0, 3)
    return adapt(AdaptRequest(motion, morphology, (contact,), (reach,)))
