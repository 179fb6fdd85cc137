"""Standing motions are kept, whatever is dragged beside them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from studio.core.grounds.ground import Ground
from studio.core.solver.grounding import grounded_motion
from studio.core.solver.request import AdaptRequest
from studio.engine.standing_solver import MAX_CACHED_GROUNDINGS, GroundingSolver
from studio.io.project.character_file import bundled_characters
from tests.builders import make_constraint
from tests.core.motions import walk

MOTION, CONTACTS = walk(60)
CHILD, GIANT = (bundled_characters()[name].morphology for name in ("child", "giant"))
FRAME = 30


@pytest.fixture
def stood(monkeypatch: pytest.MonkeyPatch) -> list[AdaptRequest]:
    """The requests for which a body was set on the ground."""
    requests, whole = list[AdaptRequest](), grounded_motion.grounded_motion_of

    def noted(request: AdaptRequest, *windows: Any) -> Any:
        requests.append(request)
        return whole(request, *windows)

    monkeypatch.setattr(grounded_motion, "grounded_motion_of", noted)
    return requests


def test_a_measure_that_is_dragged_lets_no_other_body_stand_anew(stood: list[AdaptRequest]) -> None:
    solver = GroundingSolver()
    child, giant = (AdaptRequest(MOTION, body, CONTACTS, (make_constraint(),)) for body in (CHILD, GIANT))
    for request in (child, giant):
        solver(request, 0, None)
    for step in range(2 * MAX_CACHED_GROUNDINGS):
        body = replace(CHILD, head=CHILD.head * (1.0 + 0.01 * (step + 1)))
        solver(replace(child, morphology=body), FRAME, FRAME)
    stood.clear()
    solver(giant, 0, None)
    assert not stood


def test_a_ground_that_is_dragged_to_and_fro_leaves_bodies_as_they_stood(stood: list[AdaptRequest]) -> None:
    solver, request = GroundingSolver(), AdaptRequest(MOTION, CHILD, CONTACTS, (make_constraint(),))
    before = solver(request, 0, None)
    for height in (0.1, 0.2, 0.1):
        solver(replace(request, ground=Ground(height)), FRAME, FRAME)
    stood.clear()
    assert np.array_equal(solver(request, 0, None).positions, before.positions)
    assert not stood
