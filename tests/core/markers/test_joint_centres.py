"""Joint centres and long axes of feet, from markers."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.markers.feet import feet_axes
from studio.core.markers.functional import centre_of_rotation
from studio.core.markers.joint_centres import chord, joint_centres
from studio.core.markers.label_words import side_and_part
from studio.core.markers.take import MarkerTake, centre_errors
from studio.core.markers.told_centres import measured_centre_labels
from studio.core.rotations import to_matrix
from studio.io.c3d.reader import read_c3d
from studio.io.markers.maps import find_map
from tests.core.markers.made import made_body, made_measures

# Joint centres against those that Vicon left in real files, and against a made body's own.


LEGS = {f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle")}
ARMS = {f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder", "elbow", "wrist")}


@pytest.mark.parametrize(("name", "joints"), [("btk_PiG_FullBody_walk", LEGS | ARMS), ("btk_PiG_LowerBody_walk", LEGS)])
def test_plug_in_gait_gives_the_joint_centres_that_vicon_stored(captures: Path, name: str, joints: set[str]) -> None:
    trial = read_c3d(captures / "c3d" / f"{name}.c3d").trial
    errors = centre_errors(MarkerTake(trial, find_map(trial)))
    assert set(errors) == joints
    assert max(errors.values()) < 1e-5


def test_without_stored_measures_they_are_read_off_the_stored_joints(captures: Path) -> None:
    """This file keeps its points as integers, steps of 0.1 mm, and its wands were put on up to 18 degrees off."""
    trial = read_c3d(captures / "c3d" / "sample09_PlugInC3D.c3d").trial
    errors = centre_errors(MarkerTake(trial, find_map(trial)))
    assert set(errors) == LEGS
    assert max(errors.values()) < 1e-3


places = st.tuples(*[st.floats(-1.0, 1.0)] * 3).map(np.array)


@given(places, places, places, st.floats(0.01, 0.2))
def test_a_chord_is_right_angled_at_the_joint_and_turns_away_from_the_wand(start, marker, wand, offset) -> None:
    bone = np.linalg.norm(marker - start)
    if bone < 1.2 * offset or np.linalg.norm(np.cross(marker - start, wand - start)) < 1e-3:
        return
    joint = chord(start[None], marker[None], wand[None], offset)[0]
    assert np.linalg.norm(joint - marker) == pytest.approx(offset)
    assert (joint - marker) @ (joint - start) == pytest.approx(0.0, abs=1e-9)
    normal = np.cross(marker - start, wand - start)
    assert normal @ (joint - start) == pytest.approx(0.0, abs=1e-9)
    assert np.cross(marker - start, joint - start) @ normal < 0.0


def test_two_sides_of_a_joint_give_its_middle() -> None:
    markers, joints = made_body()
    found = joint_centres({role: track[:, None] for role, track in markers.items()}, made_measures())
    for joint in ("left_hip", "right_hip", "left_knee", "right_ankle", "left_elbow", "right_wrist"):
        np.testing.assert_allclose(found[joint], joints[joint], atol=1e-9)


def test_a_wand_finds_the_knee_where_only_its_outer_side_is_marked() -> None:
    markers, joints = made_body()
    lone = {role: track[:, None] for role, track in markers.items() if "inner" not in role}
    found = joint_centres(lone, made_measures())
    assert np.linalg.norm(found["left_knee"] - joints["left_knee"], axis=1).max() < 0.01


def test_a_joint_is_found_by_how_two_clusters_turn_about_it() -> None:
    random = np.random.default_rng(3)
    centre = random.normal(size=(80, 3))
    upper, lower = (to_matrix(random.normal(size=(80, 4)) / 1.0) for _ in range(2))
    upper, lower = (np.linalg.qr(turns)[0] * [1, 1, 1] for turns in (upper, lower))
    upper, lower = (turns * np.sign(np.linalg.det(turns))[:, None, None] for turns in (upper, lower))
    shapes = random.normal(scale=0.1, size=(2, 4, 3)) + np.array([0.0, 0.1, 0.2])
    clusters = [
        centre[:, None] + shape @ np.swapaxes(turns, -1, -2)
        for shape, turns in zip(shapes, (upper, lower), strict=True)
    ]
    found = centre_of_rotation(*clusters, usual=centre + 0.05)
    assert np.linalg.norm(found - centre, axis=1).max() < 1e-3


# Joint centres among the points of a trial are told from markers by how far apart both sides lie.


PELVIS = {"L asis": 0.125, "R asis": -0.125}
"""Places of points to the left, in metres."""


def _told(places: dict[str, float], pelvis: dict[str, float] = PELVIS) -> dict[str, str]:
    labels: dict[tuple[str, str], list[str]] = {}
    for label in pelvis | places:
        side, part = side_and_part(label)
        labels.setdefault((side, part), []).append(label)
    heights = {label: {"hip": 0.9, "ankle": 0.1}.get(label.partition(" ")[2], 0.5) for label in pelvis | places}
    tracks = {label: np.tile([0.0, y, heights[label]], (10, 1)) for label, y in (pelvis | places).items()}
    return measured_centre_labels(labels, tracks)


def test_knees_too_near_to_be_markers_on_their_outer_sides_are_centres() -> None:
    assert _told({"L knee": 0.07, "R knee": -0.07}) == {"left_knee": "L knee", "right_knee": "R knee"}
    assert _told({"L knee": 0.15, "R knee": -0.15}) == {}


def test_a_centre_lies_half_as_deep_as_a_marker_on_the_inner_side() -> None:
    outer = {"L knee 1": 0.15, "R knee 1": -0.15}
    assert set(_told(outer | {"L knee": 0.09, "R knee": -0.09}).values()) == {"L knee", "R knee"}
    assert _told(outer | {"L knee": 0.03, "R knee": -0.03}) == {}


def test_hip_joints_lie_between_the_markers_of_the_pelvis() -> None:
    assert _told({"L hip": 0.09, "R hip": -0.09}) == {"left_hip": "L hip", "right_hip": "R hip"}
    assert _told({"L hip": 0.17, "R hip": -0.17}) == {}


def test_points_that_an_image_shows_at_each_joint_are_centres_where_hips_are_too_near_for_markers() -> None:
    names = ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")

    def points(hips: float) -> dict[str, float]:
        return {f"{s} {name}": sign * hips for name in names for s, sign in (("L", 1.0), ("R", -1.0))}

    assert set(_told(points(0.09), {}).values()) == set(points(0.09))
    assert _told(points(0.17), {}) == {}
    wide = points(0.09) | {f"{s} {name}": out for name in ("knee", "ankle") for s, out in (("L", 0.2), ("R", -0.2))}
    assert set(_told(wide, {}).values()) == set(wide)  # a guard in which the knees never come near each other


@pytest.mark.parametrize(
    ("label", "place"),
    [
        ("r knee 1", ("right", "knee")), ("r bar 1", ("right", "thigh")), ("l bar 2", ("left", "shank")),
        ("r mall", ("right", "ankle")), ("l met", ("left", "met")), ("r should", ("right", "shoulder")),
        ("L_HDF", ("left", "front_head")), ("L_SAJ", ("left", "shoulder")), ("R_FM1", ("right", "inner_toe")),
        ("R_FM5", ("right", "outer_toe")), ("L_UHE", ("left", "outer_wrist")), ("LTHI_2", ("left", "thigh")),
        ("CV7", ("", "neck_back")), ("TV10", ("", "back")), ("SJN", ("", "collar")), ("SXS", ("", "breastbone")),
        ("L_HM2", ("left", "hand")), ("R_TTC", ("right", "shank")), ("L_FAX", ("left", "shank")),
        ("REAS", ("right", "front_hip")), ("LEPS", ("left", "back_hip")), ("RCL", ("right", "knee")),
        ("RCM", ("right", "inner_knee")), ("LML", ("left", "ankle")), ("LMM", ("left", "inner_ankle")),
        ("RCAL", ("right", "heel")), ("LCOU_2", ("left", "elbow")), ("RMAI", ("right", "wrists")),
        ("RKL", ("right", "knee")), ("LKM", ("left", "inner_knee")), ("RAL", ("right", "ankle")),
        ("LAM", ("left", "inner_ankle")), ("RFM", ("right", "inner_toe")), ("RH", ("right", "heel")),
        ("RAC", ("right", "shoulder")), ("LKNM", ("left", "inner_knee")), ("RMED", ("right", "inner_ankle")),
        ("LVMH", ("left", "outer_toe")), ("RTHAP", ("right", "thigh")), ("LTIAD", ("left", "shank")),
        ("WaistLFront", ("left", "front_hip")), ("RToeOut", ("right", "outer_toe")), ("LHeel", ("left", "heel")),
        ("pRightASI", ("right", "front_hip")), ("pLeftKneeMedEpicondyle", ("left", "inner_knee")),
        ("R.TO", ("right", "toe")), ("LBigToe", ("left", "big_toe")), ("RMT5", ("right", "outer_toe")),
        ("LKJC", ("left", "knee centre")), ("r_shank_4X4", ("right", "knee centre")),
        ("LLEL", ("left", "elbow")), ("RFAradius", ("right", "wrist")), ("LFAulna", ("left", "outer_wrist")),
        ("R.Acromium", ("right", "shoulder")), ("LCAJ", ("left", "shoulder")), ("RLMA", ("right", "ankle")),
        ("L5TH", ("left", "outer_toe")), ("R1ST", ("right", "inner_toe")), ("RAS", ("right", "front_hip")),
        ("L.Wrist.Lat", ("left", "wrist")), ("r_mwrist", ("right", "outer_wrist")),
        ("RWristOut", ("right", "outer_wrist")),
        ("LRS", ("left", "wrist")), ("RUS", ("right", "outer_wrist")), ("left_foot_index", ("left", "toe")),
        ("Toe_Inner_L", ("left", "inner_toe")), ("R_Toe_Outer", ("right", "outer_toe")),
        ("Wrist_Pinky_L", ("left", "outer_wrist")), ("R_wrist_little", ("right", "outer_wrist")),
        ("left_pelvis_front", ("left", "front_hip")), ("Pelvis_Back_R", ("right", "back_hip")),
        ("right_calcaneus", ("right", "heel")), ("cervical_7", ("", "neck_back")), ("thoracic_8", ("", "back")),
        ("left_wrist_radial", ("left", "wrist")), ("RWristUlnar", ("right", "outer_wrist")),
        ("LShldr", ("left", "shoulder")),
        ("L_TJC", ("left", "toe")), ("left toe joint centre", ("left", "toe")), ("LWristLat", ("left", "wrist")),
        ("GGENOU", ("left", "knee")), ("Cheville_D", ("right", "ankle")), ("Talon gauche", ("left", "heel")),
    ],
)  # fmt: skip
def test_labels_of_known_sets_say_where_their_marker_is(label: str, place: tuple[str, str]) -> None:
    assert side_and_part(label) == place


# The long axis of a foot, whatever markers show its front.


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
