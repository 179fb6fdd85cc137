"""A motion is adapted the same wherever on the floor it is and whichever way it heads."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.jobs.adaptation import ReadyCapture, made_ready
from studio.resources_folder import example_captures_folder

BODIES = bundled_characters()


def _elsewhere(capture: Capture, turn: Rotation, way: np.ndarray) -> Capture:
    rotations, places = capture.poses.local_rotations.copy(), capture.poses.local_translations.copy()
    rotations[:, 0] = (turn * Rotation.from_quat(rotations[:, 0])).as_quat()
    places[:, 0] = turn.apply(places[:, 0]) + way
    return replace(capture, poses=PoseSequence(rotations, places))


def _adapted(ready: ReadyCapture, name: str) -> np.ndarray:
    body = BODIES[name]
    actor = ready.actor.morphology
    asked = AdaptRequest(ready.motion, body.morphology, ready.contacts, actor=actor, eased=True, clears=True)
    return np.asarray(adapt(asked).positions, dtype=np.float64)


@pytest.mark.parametrize("stem", ["walk_turn", "straight_punch", "cartwheel", "handstand"])
@pytest.mark.parametrize("name", ["child", "giant"])
def test_who_heads_elsewhere_does_the_same(stem: str, name: str) -> None:
    capture = load_capture(example_captures_folder() / f"{stem}.bvh")
    turn = Rotation.from_euler("z", 2.4)
    here, there = (
        _adapted(made_ready(each), name) for each in (capture, _elsewhere(capture, turn, np.array([30.0, -20.0, 0.0])))
    )
    back = turn.inv().apply((there - there[0, 0]).reshape(-1, 3)).reshape(there.shape)
    assert np.abs(back - (here - here[0, 0])).max() < 1e-4
