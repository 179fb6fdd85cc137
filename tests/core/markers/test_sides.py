"""Places that carry another place's name through a take are found, and no others."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from studio.core.markers.ends import exchanged_ends, exchanged_on_limbs, with_roles
from studio.core.markers.marker_map import MarkerMap
from studio.core.markers.sides import exchanged_places, with_sides_exchanged
from studio.core.markers.trial import Trial
from tests.core.markers.made import made_trial, turned

# Places that carry the name of the other side through a take are found, and no others.


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


# Places of one side that carry each other's name through a take are found, and no others.


def _exchanged(marker_map: MarkerMap, one: str, other: str, sides: tuple[str, ...]) -> MarkerMap:
    pairs = [(f"{side}_{one}", f"{side}_{other}") for side in sides if side] or [(one, other)]
    return with_roles(marker_map, {role: to for pair in pairs for role, to in (pair, pair[::-1])})


def _found(trial: Trial, marker_map: MarkerMap) -> MarkerMap:
    in_order = with_roles(marker_map, exchanged_ends(trial, marker_map))
    return with_roles(in_order, exchanged_on_limbs(trial, in_order))


PAIRS = (
    ("front_hip", "back_hip"), ("heel", "toe"), ("wrist", "outer_wrist"), ("ankle", "heel"), ("ankle", "toe"),
    ("knee", "ankle"), ("thigh", "knee"), ("shank", "ankle"), ("elbow", "wrist"), ("shoulder", "elbow"),
)  # fmt: skip


@pytest.mark.parametrize(("pair", "sides"), [*product(PAIRS, [("left",), ("left", "right")])])
@pytest.mark.parametrize("lies", [False, True])
def test_ends_that_were_exchanged_are_found_again(pair: tuple[str, str], sides: tuple[str, ...], lies: bool) -> None:
    trial, marker_map = made_trial()
    if lies:
        trial = trial.with_points(trial.points @ turned("y", np.array([1.5]))[0])
    assert _found(trial, _exchanged(marker_map, *pair, sides)) == marker_map


@pytest.mark.parametrize("pair", [("collar", "neck_back"), ("breastbone", "back")])
def test_the_trunks_front_and_back_are_found_again(pair: tuple[str, str]) -> None:
    trial, marker_map = made_trial()
    assert _found(trial, _exchanged(marker_map, *pair, ("",))) == marker_map


def test_four_markers_of_the_pelvis_are_found_in_any_two_exchanges() -> None:
    trial, marker_map = made_trial()
    for one, other in (("left_front_hip", "right_back_hip"), ("right_front_hip", "right_back_hip")):
        assert _found(trial, with_roles(marker_map, {one: other, other: one})) == marker_map


def test_a_body_as_it_is_is_left_so() -> None:
    trial, marker_map = made_trial()
    assert not exchanged_ends(trial, marker_map)
    assert not exchanged_on_limbs(trial, marker_map)


def test_a_head_that_looks_over_its_shoulder_is_left_so() -> None:
    trial, marker_map = made_trial()
    points = trial.points.copy()
    head = [trial.labels.index(f"{side}{end}head") for end in ("front", "back") for side in ("left", "right")]
    points[:, head] = points[:, [head[1], head[3], head[0], head[2]]]
    assert not exchanged_ends(trial.with_points(points), marker_map)


def test_folded_limbs_that_stay_folded_are_left_so() -> None:
    """A wrist beside its shoulder, an ankle beside its hip."""
    trial, marker_map = made_trial()
    points = np.tile(trial.points[:1], (60, 1, 1))
    for side, (low, high) in product(("left", "right"), (("wrist", "shoulder"), ("outerwrist", "shoulder"))):
        to = points[:, trial.labels.index(f"{side}{high}")] + [160.0, 0.0, -80.0 if low == "wrist" else -130.0]
        points[:, trial.labels.index(f"{side}{low}")] = to
    still = replace(trial, points=points, residuals=trial.residuals[:60])
    assert not exchanged_on_limbs(still, marker_map)
