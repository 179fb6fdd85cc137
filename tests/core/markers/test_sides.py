"""Places that carry the name of the other side through a take are found, and no others."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.markers.marker_map import MarkerMap
from studio.core.markers.sides import exchanged_places, with_sides_exchanged
from tests.core.markers.made import made_trial

LEG = {"knee", "inner_knee", "thigh", "ankle", "inner_ankle", "shank", "heel", "toe"}
ARM = {"elbow", "inner_elbow", "wrist", "outer_wrist"}
GIRDLES = {"front_hip", "back_hip", "shoulder", "front_head", "back_head"}


@pytest.mark.parametrize(
    "names", [set(), LEG, ARM, LEG | ARM, {"knee", "inner_knee"}, {"ankle"}, {"front_hip"}, LEG | ARM | GIRDLES]
)
@pytest.mark.parametrize("moves", [True, False])
def test_what_was_exchanged_is_found_again(names: set[str], moves: bool) -> None:
    trial, marker_map = made_trial()
    if not moves:
        trial = replace(trial, points=np.tile(trial.points[:1], (20, 1, 1)), residuals=trial.residuals[:20])
    wrong = with_sides_exchanged(marker_map, tuple(names))
    found = exchanged_places(trial, wrong)
    assert set(found) == names
    assert with_sides_exchanged(wrong, found) == marker_map


def test_a_body_that_lies_or_turns_is_sorted_by_itself() -> None:
    trial, marker_map = made_trial()
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    turned = trial.with_points(trial.points @ turn)
    assert exchanged_places(turned, marker_map) == ()
    assert set(exchanged_places(turned, with_sides_exchanged(marker_map, tuple(LEG)))) == LEG


@pytest.mark.parametrize("names", [{"wrist", "outer_wrist"}, {"ankle", "inner_ankle", "heel", "toe"}])
def test_ends_of_limbs_that_stand_still_are_found_though_the_others_are_nearer(names: set[str]) -> None:
    """Limbs that are folded all the time have shorter bones than that."""
    trial, marker_map = made_trial()
    frame = trial.points[60:61].copy()
    for name in ("wrist", "outerwrist"):
        for side in ("left", "right"):
            frame[:, trial.labels.index(f"{side}{name}"), 1] *= 0.4
    still = replace(trial, points=np.tile(frame, (20, 1, 1)), residuals=trial.residuals[:20])
    assert exchanged_places(still, marker_map) == ()
    assert set(exchanged_places(still, with_sides_exchanged(marker_map, tuple(names)))) == names


def test_folded_arms_are_nobody_elses() -> None:
    """Each hand lies beside the other elbow all through the take."""
    trial, marker_map = made_trial()
    points = np.tile(trial.points[:1], (trial.frame_count, 1, 1))
    for side, other in (("left", "right"), ("right", "left")):
        at = trial.labels.index(f"{other}elbow")
        for name, beside in (("wrist", 60.0), ("outerwrist", 30.0)):
            points[:, trial.labels.index(f"{side}{name}")] = points[:, at] + [beside, 0.0, 40.0]
    assert not ARM & set(exchanged_places(trial.with_points(points), marker_map))


def test_without_a_front_and_a_back_nothing_is_said() -> None:
    trial, _ = made_trial(("left_knee", "right_knee"))
    assert exchanged_places(trial, MarkerMap("x", {"left_knee": ("leftknee",), "right_knee": ("rightknee",)})) == ()
