"""Places within a trunk's reach are reached to the millimetre."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.request import AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk(60)
HEAD = BodyPoint(BodyPart.HEAD, at_end=True)
CHAIN = Chain(limb=1.0, clavicle=0.0, trunk=1.0, end_segment=1.0)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize("aside", [(0.5, 0.0), (0.0, 0.5), (-0.5, 0.0), (0.0, -0.5)])
@pytest.mark.parametrize("depth", [0.04, 0.08, 0.12])
def test_a_head_that_ducks_aside_gets_there_by_the_trunk_alone(
    body: Morphology, aside: tuple[float, float], depth: float
) -> None:
    """``depth`` for a stature of 1.7 m; the spine buckles, which takes more steps than reaching out."""
    way = depth * body.stature / 1.7 * np.array([*aside, -1.0]) / np.hypot(0.5, 1.0)
    place = body_point_positions(HEAD, adapt(AdaptRequest(WALK, body, CONTACTS)))[30] + way
    held = ActivationCurve(0.0, 0.2, 0.8, 1.0)
    asked = PositionConstraint("walk", "Duck", HEAD, CHAIN, 1, held, target=tuple(place.tolist()))
    found = adapt(AdaptRequest(WALK, body, CONTACTS, (asked,)))
    assert np.linalg.norm(body_point_positions(HEAD, found)[30] - place) < 1e-3
