"""Joint centres among the points of a trial are told from markers by how far apart both sides lie."""

import numpy as np
import pytest

from studio.core.markers.label_words import side_and_part
from studio.core.markers.told_centres import measured_centre_labels

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
        ("GGENOU", ("left", "knee")), ("Cheville_D", ("right", "ankle")), ("Talon gauche", ("left", "heel")),
    ],
)  # fmt: skip
def test_labels_of_known_sets_say_where_their_marker_is(label: str, place: tuple[str, str]) -> None:
    assert side_and_part(label) == place
