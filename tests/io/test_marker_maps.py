"""Marker maps in files: shipped ones, saved ones, and which is taken for a trial."""

from pathlib import Path

import pytest

from studio.core.markers.marker_map import MarkerMap
from studio.io.c3d.reader import read_c3d
from studio.io.importing import load_capture
from studio.io.markers.maps import find_map, find_subject, known_maps, maps_folder, read_map, save_map
from tests.core.markers.made import made_trial
from tests.io.trials import make_trial


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("btk_PiG_FullBody_walk", "Plug-in-Gait"),
        ("btk_PiG_LowerBody_walk", "Plug-in-Gait"),
        ("btk_shd01_prefix", "Plug-in-Gait"),
        ("sample09_PlugInC3D", "Plug-in-Gait with a sacrum marker"),
        ("btk_mocap36_optitrack", "OptiTrack baseline"),
        ("btk_Gait_dec_int", "proposed from marker names and positions"),
    ],
)
def test_known_sets_are_recognised(captures: Path, file: str, name: str) -> None:
    trial = read_c3d(captures / "c3d" / f"{file}.c3d").trial
    assert find_map(trial, find_subject(trial)).name == name


def test_a_saved_map_comes_back_and_is_used_for_the_next_trial_of_its_set() -> None:
    trial, own = made_trial()
    assert find_map(trial).name != "made"
    path = save_map(own)
    try:
        assert path.parent == maps_folder()
        assert read_map(path) == own
        assert own in known_maps()
        assert find_map(trial) == own
    finally:
        path.unlink()


def test_every_shipped_map_can_follow_legs_or_arms() -> None:
    assert len(known_maps()) >= 6
    assert all(known.has_legs() or known.has_arms() for known in known_maps())


def test_of_several_subjects_the_one_with_most_markers_is_read() -> None:
    trial = make_trial(("Ann:LASI", "Ben:LASI", "Ben:RASI"))
    assert find_subject(trial) == "Ben"
    assert find_subject(make_trial(("Ann:LASI", "Ann:RASI"))) == ""


def test_a_map_knows_what_is_missing_in_words() -> None:
    lacking = MarkerMap("x", {"left_knee": ("A",)}).missing_positions()
    assert "right knee" in lacking
    assert "left knee" not in lacking


def test_a_damaged_map_among_the_users_own_is_left_out_and_told(captures: Path) -> None:
    maps_folder().mkdir(parents=True, exist_ok=True)
    path = maps_folder() / "broken.json"
    path.write_text("{")
    try:
        capture = load_capture(captures / "c3d" / "btk_PiG_LowerBody_walk.c3d")
    finally:
        path.unlink()
    assert capture.markers.marker_map.name == "Plug-in-Gait"
    assert "broken.json is not readable as JSON" in capture.repairs[-1]
