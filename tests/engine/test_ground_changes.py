"""The ground may change between any two frames that are shown: what comes is what would have been from the start."""

import math
from dataclasses import replace

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds import Bumps, HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.engine.standing_solver import GroundingSolver
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk
from tests.core.test_touching import guard

MOTION, CONTACTS = walk(120)
BODY = bundled_characters()["child"].morphology
SEEN = 1e-4
"""Metres: less, as the solver keeps poses in 32 bits, is seen by nobody."""
GROUNDS = (
    Ground(),
    Steps(0.0, 0.17, 0.30, 12, 0.0, (0.4, 0.0)),
    Steps(0.0, -0.17, 0.30, 12, 0.0, (0.4, 0.0)),
    Slope(0.1, math.radians(15.0)),
    Bumps(0.0, 0.08, 1.2, 1),
    HeightMap(0.0, 0.1 * np.random.default_rng(1).normal(size=(20, 20)), 0.6, (-4.0, -6.0)),
    SurfaceMesh(0.0, [[-9.0, -9.0, 0.0], [9.0, -9.0, 0.5], [0.0, 9.0, 0.2]], [[0, 1, 2]]),
    Ground(-0.2),
    Ground(),
)


def test_a_ground_that_changes_between_two_frames_leaves_no_trace_of_the_one_before() -> None:
    """Frames of a window, as while something is dragged, then of the whole clip, each on the next ground."""
    solver, request = GroundingSolver(), AdaptRequest(MOTION, BODY, CONTACTS)
    for frame, ground in enumerate(GROUNDS, start=50):
        shown = solver(replace(request, ground=ground), frame, frame)
        fresh = adapt(replace(request, ground=ground)).kept()
        assert np.array_equal(shown.positions[0], fresh.positions[frame])
        assert np.array_equal(shown.rotations[0], fresh.rotations[frame])
    whole = solver(request, 0, None)
    assert np.array_equal(whole.positions, adapt(request).kept().positions)


def test_a_frame_of_a_body_that_changes_is_as_in_the_whole_clip_its_arms_out_of_the_body_too() -> None:
    """Each body is new to the solver, as while a measure is dragged; a place is the body's own of another moment."""
    (motion, actor, contacts), solver = guard(), GroundingSolver()
    wrist, curve = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), ActivationCurve(0.0, 0.3, 5.0, 5.0)
    own = OwnPlace(wrist, motion.duration, (0.05, 0.0, 0.05))
    asked = (
        PositionConstraint("motion", "reach", wrist, Chain(trunk=1.0), 0, curve, target=own),
        BalanceConstraint("motion", "balance", BodyPoint(BodyPart.PELVIS), Chain(root=1.0), 1, curve, place=Support()),
    )
    for frame, name in ((0, "giant"), (20, "child"), (60, "stocky_man")):
        body = bundled_characters()[name].morphology
        request = AdaptRequest(motion, body, contacts, asked, actor=actor, clears=True)
        shown, whole = solver(request, frame, frame), adapt(request)
        assert np.abs(shown.positions[0] - whole.positions[frame]).max() < SEEN
        rest = solver(request, 0, None)
        assert np.abs(rest.positions[:] - whole.positions).max() < SEEN
