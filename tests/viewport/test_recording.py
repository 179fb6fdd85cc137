"""Markers, plates and forces on the stage: where the body is that was found from them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyLayout
from studio.core.markers.take import MarkerTake
from studio.core.normalized.normalize import motion_origin, normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.stage.placement import Placement
from studio.io.importing import GUESS_ALL, load_capture
from studio.io.markers.capture import capture_of_take
from studio.viewport.optical_recording import METRES_A_NEWTON, RecordingOfPerformer
from tests.core.markers.made import made_trial


def joint_of(body, layout: BodyLayout, name: str, frame: int):
    return body[frame, layout.point_names().index(name)]


@pytest.mark.parametrize("name", ["btk_PiG_FullBody_walk", "sample09_PlugInC3D", "btk_Gait_dec_int"])
def test_markers_lie_on_the_body_that_was_found_from_them(captures: Path, name: str) -> None:
    capture = load_capture(captures / "c3d" / f"{name}.c3d")
    motion, actor = normalize_capture(capture)
    assert np.allclose(motion_origin(capture), actor.origin, atol=1e-12)
    body = realize_motion(motion, actor.morphology, play=True)[0]
    drawn = RecordingOfPerformer(capture)
    place = Placement((2.0, -1.0), 0.7)
    for frame in range(capture.first_frame, capture.frame_count, 40):
        now = drawn.at(frame, place)
        for marker, joint in (("LKNE", "left knee"), ("RKNE", "right knee"), ("LELB", "left elbow")):
            if marker in now.labels:
                found = place.to_stage(joint_of(body, actor.morphology.layout, joint, frame))
                assert np.linalg.norm(now.points[now.labels.index(marker)] - found) < 0.12, (frame, marker)


def test_a_marker_that_no_camera_saw_is_not_drawn_and_one_of_no_place_is_told_apart() -> None:
    trial, marker_map = made_trial()
    points = trial.points.copy()
    hidden, stray = trial.labels[0], trial.labels[1]
    points[10:20, 0] = np.nan
    roles = {role: tuple(label for label in own if label != stray) for role, own in marker_map.markers.items()}
    take = MarkerTake(replace(trial, points=points), replace(marker_map, markers=roles))
    drawn = RecordingOfPerformer(capture_of_take(take, GUESS_ALL))
    before, inside = (drawn.at(frame, Placement()) for frame in (9, 10))
    assert hidden in before.labels
    assert set(before.labels) - set(inside.labels) == {hidden}
    assert len(inside.points) == len(inside.used) == len(inside.labels)
    assert [label for label, used in zip(before.labels, before.used, strict=True) if not used] == [stray]


def test_a_foot_on_a_plate_is_pushed_up_where_it_stands(captures: Path) -> None:
    capture = load_capture(captures / "c3d" / "btk_Gait_dec_int.c3d")
    assert capture.markers is not None
    plates = len(capture.markers.trial.plates)
    drawn = RecordingOfPerformer(capture)
    standing = 0
    for frame in range(capture.first_frame, capture.frame_count):
        now = drawn.at(frame, Placement())
        assert len(now.paths) >= plates
        for force in now.paths[plates:]:
            begin, end = force.points
            newtons = (end - begin) / METRES_A_NEWTON
            if newtons[2] > 400.0:
                standing += 1
                feet = [index for index, label in enumerate(now.labels) if label[1:4] in ("FOO", "HEE", "ANK")]
                assert np.linalg.norm(now.points[feet, :2] - begin[:2], axis=1).min() < 0.2
                assert abs(begin[2]) < 0.05
    assert standing > 50


def test_eight_points_of_nobody_and_a_plate_are_shown_as_such(captures: Path) -> None:
    capture = load_capture(captures / "c3d" / "sample15_FP1_metres.c3d")
    assert capture.body_map is None
    assert "The file holds 8 markers, 1 force plate, 12 signals." in capture.guesses[0].reason
    now = RecordingOfPerformer(capture).at(250, Placement())
    assert len(now.points) == 8
    assert not now.used.any()
    plate, force = now.paths
    assert np.abs(plate.points).max() <= 0.9 + 1e-6
    assert (force.points[1] - force.points[0])[2] > 0.02
