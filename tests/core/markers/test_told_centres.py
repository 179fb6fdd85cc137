"""Joint centres among the points of a trial are told from markers by how far apart both sides lie."""

import numpy as np
import pytest

from studio.core.markers.proposing import part_of
from studio.core.markers.told_centres import told_centres

PELVIS = {"L asis": 0.125, "R asis": -0.125}
"""Where points lie to the left, in metres."""


def _told(places: dict[str, float]) -> dict[str, str]:
    labels: dict[tuple[str, str], list[str]] = {}
    for label in PELVIS | places:
        side, part = part_of(label)
        labels.setdefault((side, part), []).append(label)
    tracks = {label: np.tile([0.0, y, 0.5], (10, 1)) for label, y in (PELVIS | places).items()}
    return told_centres(labels, tracks)


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


@pytest.mark.parametrize(
    ("label", "place"),
    [
        ("r knee 1", ("right", "knee")), ("r bar 1", ("right", "thigh")), ("l bar 2", ("left", "shank")),
        ("r mall", ("right", "ankle")), ("l met", ("left", "toe")), ("r should", ("right", "shoulder")),
        ("L_HDF", ("left", "front_head")), ("L_SAJ", ("left", "shoulder")), ("R_FM1", ("right", "toe")),
        ("R_FM5", ("right", "toe")), ("L_UHE", ("left", "outer_wrist")), ("LTHI_2", ("left", "thigh")),
        ("CV7", ("", "neck_back")), ("TV10", ("", "back")), ("SJN", ("", "collar")), ("SXS", ("", "breastbone")),
        ("L_HM2", ("left", "hand")), ("R_TTC", ("right", "shank")), ("L_FAX", ("left", "shank")),
    ],
)  # fmt: skip
def test_labels_of_known_sets_say_where_their_marker_is(label: str, place: tuple[str, str]) -> None:
    assert part_of(label) == place
