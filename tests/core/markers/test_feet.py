"""The long axis of a foot, whatever markers show its front."""

import numpy as np
import pytest

from studio.core.markers.feet import feet_axes

HEEL = np.array([0.0, 0.0, 0.04])
AXIS = np.array([0.19, 0.0, 0.03])
"""The middle between the metatarsals of a foot that points along x."""
HALF = 0.19 * np.tan(np.radians(12.0))


def _tracks(side: str, **places: np.ndarray) -> dict[str, np.ndarray]:
    own = {"heel": HEEL, "knee": np.array([0.06, 0.0, 0.5]), "ankle": np.array([0.05, 0.0, 0.1])} | places
    tracks = {f"{side}_{name}": np.tile(place, (8, 1)) for name, place in own.items()}
    return tracks | {f"{side}_front_hip": np.tile([0.1, 0.0, 0.95], (8, 1))}


@pytest.mark.parametrize(("side", "out"), [("left", 1.0), ("right", -1.0)])
@pytest.mark.parametrize("shown", [("inner_toe", "outer_toe"), ("outer_toe",), ("inner_toe",), ("toe",)])
def test_toes_lie_between_the_first_and_the_fifth_metatarsal(side: str, out: float, shown: tuple[str, ...]) -> None:
    edge = np.array([0.0, out * HALF, 0.0])
    places = {"toe": AXIS, "inner_toe": AXIS - edge, "outer_toe": AXIS + edge}
    found = feet_axes(_tracks(side, **{name: places[name] for name in shown}))[f"{side}_toe"]
    along = found - HEEL
    assert np.abs(np.degrees(np.arctan2(along[:, 1], along[:, 0]))).max() < 1.0
    assert np.abs(found - AXIS).max() < 0.006


@pytest.mark.parametrize(("side", "out"), [("left", 1.0), ("right", -1.0)])
@pytest.mark.parametrize("name", ["big_toe", "toe"])
@pytest.mark.parametrize("without", ["", "heel", "front_hip"])
def test_a_marker_on_the_tip_of_the_big_toe_is_beyond_the_ball(side: str, out: float, name: str, without: str) -> None:
    """A foot of 27 cm, whose hallux ends 67 mm before its ball and 22 mm inside its long axis."""
    tracks = _tracks(side, **{name: np.array([0.257, -out * 0.022, 0.025])})
    tracks.pop(f"{side}_{without}", None)
    found = feet_axes(tracks)[f"{side}_toe"]
    assert np.abs(found - AXIS).max() < (0.03 if without == "heel" else 0.015)


@pytest.mark.parametrize("name", ["big_toe", "toe"])
def test_a_marker_on_the_ball_stays_there_whatever_it_is_called(name: str) -> None:
    np.testing.assert_allclose(feet_axes(_tracks("left", **{name: AXIS}))["left_toe"][0], AXIS, atol=1e-12)


def test_the_fifth_metatarsal_is_surer_than_the_tip_of_a_toe() -> None:
    edge, tip = np.array([0.0, HALF, 0.0]), np.array([0.257, -0.022, 0.025])
    found = feet_axes(_tracks("left", big_toe=tip, outer_toe=AXIS + edge))["left_toe"]
    assert np.abs(found - AXIS).max() < 0.006


def test_both_metatarsals_are_surer_than_the_tip_of_a_toe() -> None:
    edge, tip = np.array([0.0, HALF, 0.0]), AXIS + np.array([0.06, -0.03, 0.0])
    found = feet_axes(_tracks("left", toe=tip, inner_toe=AXIS - edge, outer_toe=AXIS + edge))
    np.testing.assert_allclose(found["left_toe"][0], AXIS, atol=1e-12)


def test_markers_in_the_middle_of_a_foot_are_drawn_to_its_ends_along_it() -> None:
    behind, before = np.array([0.05, 0.02, 0.03]), np.array([0.11, 0.02, 0.03])
    found = feet_axes(_tracks("left", heel=behind, toe=before))
    length = found["left_toe"][0] - found["left_heel"][0]
    assert 0.13 < np.linalg.norm(length) < 0.2
    np.testing.assert_allclose(np.cross(length, before - behind), 0.0, atol=1e-12)
    np.testing.assert_allclose(0.5 * (found["left_toe"] + found["left_heel"])[0], 0.5 * (behind + before), atol=1e-12)
    assert "left_heel" not in feet_axes(_tracks("left", toe=AXIS))
