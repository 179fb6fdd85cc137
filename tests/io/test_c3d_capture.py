"""From C3D to a capture that can be retargeted, and from any motion back to C3D as virtual markers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_positions, joint_world
from studio.core.captures.virtual_markers import virtual_trial
from studio.core.errors import StudioError
from studio.core.markers.cleaning import LowPass
from studio.core.markers.marker_map import MarkerMap
from studio.core.markers.take import centre_errors
from studio.core.markers.trial import TRIAL_UNIT_METRES, ForcePlate
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.round_trip import round_trip
from studio.core.stage.project import Project
from studio.io.c3d.reader import read_c3d
from studio.io.c3d.writer import write_c3d
from studio.io.export import take_of_capture, write_take
from studio.io.importing import GUESS_ALL, ImportOptions, known_of_motion, load_capture, read_capture
from studio.io.markers.capture import capture_of_take
from studio.io.markers.unit import with_plausible_unit
from studio.io.project.project_file import read_project, write_project
from studio.io.up_axis import FILE_AXES
from tests.core.markers.made import made_body, made_trial
from tests.core.markers.made import turned as made_turn
from tests.io.test_c3d import FILES
from tests.io.trials import same

WITHOUT_A_BODY = {"sample15_FP1_metres"}
WITH_A_BODY = tuple(name for name in FILES if name not in WITHOUT_A_BODY)


@pytest.mark.parametrize("name", WITH_A_BODY)
def test_every_shared_body_can_be_retargeted_like_any_other(captures: Path, name: str) -> None:
    capture = load_capture(captures / "c3d" / f"{name}.c3d")
    assert capture.body_map is not None
    assert round_trip(capture, *normalize_capture(capture)).position < 1e-4
    feet = [capture.skeleton.index(f"{side}{part}") for side in ("Left", "Right") for part in ("Foot", "Toe")]
    heights = joint_world(capture.skeleton, capture.poses)[0][capture.first_frame :, feet, 2] - capture.floor
    # Legs that no marker shows are of usual length: those of btk_shd01_prefix would end under its plates.
    legs_shown = not any(guess.subject == "not shown" and "legs" in guess.value for guess in capture.guesses)
    assert legs_shown == (name != "btk_shd01_prefix")
    assert -0.05 < np.percentile(heights, 5) < 0.15 or not legs_shown


def test_points_without_names_open_as_bare_markers_and_say_what_to_do(captures: Path) -> None:
    capture = load_capture(captures / "c3d" / "sample15_FP1_metres.c3d")
    assert capture.body_map is None
    assert capture.skeleton.names == ("Markers", *(f"PT{index:02d}" for index in range(8)))
    [guess] = [guess for guess in capture.guesses if guess.subject == "marker map"]
    assert "Assign them under Edit > Markers; the map can be saved and used again." in guess.reason
    trial = capture.markers.trial
    positions = joint_world(capture.skeleton, capture.poses)[0]
    np.testing.assert_allclose(positions[:, 1, 2], trial.points[:, 0, 2], atol=1e-12)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_legs_alone_show_that_a_camera_is_tilted_by_25_degrees(tmp_path: Path, axis: str) -> None:
    above = ("shoulder", "elbow", "wrist", "head", "neck", "collar", "breastbone")
    roles = [role for role in made_body()[0] if role != "back" and not any(word in role for word in above)]
    trial, _ = made_trial(tuple(roles))
    turn = made_turn(axis, np.radians([25.0]))[0]
    write_c3d(tmp_path / "t.c3d", trial.with_points(trial.points @ turn))
    direction = np.array(load_capture(tmp_path / "t.c3d").up_axis.split(), dtype=float)
    assert np.degrees(np.arccos(direction @ turn[2])) < 6.0


def test_labels_that_were_exchanged_are_put_right_and_reported(tmp_path: Path) -> None:
    trial, _ = made_trial()
    names = {"leftheel": "lefttoe", "lefttoe": "leftheel"}
    write_c3d(tmp_path / "t.c3d", replace(trial, labels=tuple(names.get(label, label) for label in trial.labels)))
    capture = load_capture(tmp_path / "t.c3d")
    assert capture.markers is not None
    assert capture.markers.marker_map.markers["left_heel"] == ("lefttoe",)
    [guess] = [guess for guess in capture.guesses if guess.subject == "places"]
    assert guess.reason.startswith("leftheel, lefttoe are at each other's body locations")


def test_a_map_said_by_hand_makes_a_body_of_bare_markers() -> None:
    trial, marker_map = made_trial()
    names = {label: f"P{index}" for index, label in enumerate(trial.labels)}
    unnamed = replace(trial, labels=tuple(names.values()))
    said = MarkerMap("ours", {role: (names[label],) for role, (label,) in marker_map.markers.items()})
    capture = load_capture_of(unnamed, ImportOptions(marker_map=said))
    assert capture.body_map is not None
    assert load_capture_of(unnamed, GUESS_ALL).body_map is None


@pytest.mark.parametrize("hidden", [(), ("elbow", "shoulder"), ("hip",)])
def test_every_guess_about_markers_says_how_far_it_can_be_trusted(hidden: tuple[str, ...]) -> None:
    trial, _ = made_trial()
    labels = tuple(
        f"*{index}" if any(word in label for word in hidden) else label for index, label in enumerate(trial.labels)
    )
    points = trial.points.copy()
    points[:5] = np.nan
    two = tuple(f"Ann:{label}" for label in labels[: len(labels) // 2]) + labels[len(labels) // 2 :]
    for named in (labels, two):
        capture = load_capture_of(replace(trial, labels=named, points=points), GUESS_ALL)
        assert capture.guesses
        assert all(guess.confidence for guess in capture.guesses), [guess.title for guess in capture.guesses]


def load_capture_of(trial, options):
    from studio.core.markers.take import MarkerTake
    from studio.io.markers.maps import find_map

    return capture_of_take(MarkerTake(trial, options.marker_map or find_map(trial)), options)


def test_a_lower_body_says_that_its_arms_are_at_rest(captures: Path) -> None:
    capture = load_capture(captures / "c3d" / "btk_PiG_LowerBody_walk.c3d")
    [guess] = [guess for guess in capture.guesses if guess.subject == "not shown"]
    assert guess.value == "head and arms"
    assert "The head needs markers at three body locations and has 0." in guess.reason
    assert "The arms lack markers at left shoulder, right shoulder, left elbow" in guess.reason


@pytest.mark.parametrize(
    ("open_places", "sentence"),
    [
        (("left_shoulder",), "The arms lack markers at left shoulder. Parts"),
        (("left_front_head", "right_front_head"), "The head needs markers at three body locations and has 2."),
    ],
)
def test_what_is_not_shown_is_told_by_the_places_it_lacks_and_the_markers_left_over(
    open_places: tuple[str, ...], sentence: str
) -> None:
    trial, marker_map = made_trial()
    left_over = [label for place in open_places for label in marker_map.markers[place]]
    for place in open_places:
        marker_map = marker_map.with_role(place, ())
    capture = load_capture_of(trial, ImportOptions(marker_map=marker_map))
    [guess] = [guess for guess in capture.guesses if guess.subject == "not shown"]
    assert sentence in guess.reason
    assert guess.reason.endswith(f"Not in the marker map: {', '.join(left_over)}.")


def test_frames_without_a_body_at_the_end_are_told_where_nothing_else_is() -> None:
    trial, marker_map = made_trial()
    points = trial.points.copy()
    points[-2:] = np.nan
    capture = load_capture_of(replace(trial, points=points), ImportOptions(marker_map=marker_map))
    [guess] = [guess for guess in capture.guesses if guess.subject == "frames"]
    assert guess.value == str(capture.frame_count) == str(trial.frame_count - 2)
    assert f"Of the {trial.frame_count} recorded, 2 at the end show no body" in guess.reason


@pytest.mark.parametrize("joint", ["knee", "ankle"])
def test_joints_of_the_other_leg_are_told_where_bones_cannot_follow(joint: str) -> None:
    trial, marker_map = made_trial()

    def told(one: MarkerMap) -> str:
        capture = load_capture_of(trial, ImportOptions(marker_map=one))
        return " ".join(guess.reason for guess in capture.guesses if guess.subject in ("skeleton", "sides"))

    swapped = marker_map
    for role in (joint, f"inner_{joint}"):
        left, right = (marker_map.markers[f"{side}_{role}"] for side in ("left", "right"))
        swapped = swapped.with_role(f"left_{role}", right).with_role(f"right_{role}", left)
    assert "swapped" not in told(marker_map)
    assert "labels of left and right may be swapped" in told(swapped)


def test_legs_that_carry_each_others_names_are_put_right_and_told() -> None:
    trial, _ = made_trial()
    names = {label: label.replace("left", "L").replace("right", "R") for label in trial.labels}
    leg = ("knee", "ankle", "thigh", "shank", "heel", "toe")
    swapped = {
        label: ("R" + name[1:] if name[0] == "L" else "L" + name[1:]) if label.endswith(leg) else name
        for label, name in names.items()
    }
    right, wrong = (
        load_capture_of(replace(trial, labels=tuple(own[label] for label in trial.labels)), GUESS_ALL)
        for own in (names, swapped)
    )
    assert "legs" not in " ".join(guess.value for guess in right.guesses)
    assert np.array_equal(wrong.poses.local_rotations, right.poses.local_rotations)
    assert not [guess for guess in right.guesses if guess.subject == "sides"]
    [guess] = [guess for guess in wrong.guesses if guess.subject == "sides"]
    assert guess.value == "left and right swapped, corrected"


def test_frames_in_which_a_foot_is_not_yet_seen_size_no_foot() -> None:
    """The toes come into sight after two thirds of the take, while the body walks on."""
    trial, marker_map = made_trial()
    points = trial.points.copy()
    late = [trial.labels.index(label) for label in ("lefttoe", "leftheel", "leftankle", "leftinnerankle")]
    points[:100, late] = np.nan
    whole, cut = (
        load_capture_of(trial.with_points(each), ImportOptions(marker_map=marker_map))
        for each in (trial.points, points)
    )
    for joint in ("LeftFoot", "LeftToe"):
        lengths = [np.linalg.norm(each.skeleton.offsets[each.skeleton.index(joint)]) for each in (whole, cut)]
        assert lengths[1] == pytest.approx(lengths[0], abs=0.003)
    assert not any("swapped" in guess.reason for guess in cut.guesses)


@pytest.mark.parametrize(("height", "floor"), [(-0.05, -0.05), (0.06, 0.06), (0.4, 0.0)])
def test_level_plates_under_the_feet_are_the_floor_and_others_are_not(height: float, floor: float) -> None:
    trial, marker_map = made_trial()
    corners = 1000.0 * np.array([[0.5, 0.5, height], [0.0, 0.5, height], [0.0, 0.0, height], [0.5, 0.0, height]])
    tilted = corners + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 80.0], [0.0, 0.0, 80.0], [0.0, 0.0, 0.0]])
    plates = tuple(ForcePlate(2, each, np.zeros(3), (0, 1, 2, 3, 4, 5)) for each in (tilted, corners))
    capture = load_capture_of(replace(trial, plates=plates), ImportOptions(marker_map=marker_map))
    without = load_capture_of(trial, ImportOptions(marker_map=marker_map))
    assert capture.floor == pytest.approx(floor if abs(height) < 0.2 else without.floor)


def test_a_unit_that_makes_a_giant_is_overruled_and_listed() -> None:
    trial, marker_map = made_trial()
    for said in TRIAL_UNIT_METRES:
        believed, _, guesses = with_plausible_unit(replace(trial, unit=said), marker_map, "", None)
        assert believed.unit == "mm"
        assert [guess.subject for guess in guesses] == ([] if said == "mm" else ["unit"])


@pytest.mark.parametrize("unit", TRIAL_UNIT_METRES)
def test_a_trial_in_any_unit_that_says_another_is_the_same_body(unit: str) -> None:
    trial, marker_map = made_trial()
    wrong = replace(trial.with_points(trial.points * (0.001 / TRIAL_UNIT_METRES[unit])), unit="mm", measures={})
    believed, _, guesses = with_plausible_unit(wrong, marker_map, "", None)
    assert believed.unit == unit
    assert len(guesses) == (unit != "mm")


@pytest.mark.parametrize("axis", FILE_AXES)
def test_the_axis_that_is_up_is_found(axis: str) -> None:
    trial, marker_map = made_trial()
    turned = trial.with_points(trial.points @ FILE_AXES[axis])
    capture = load_capture_of(turned, ImportOptions(marker_map=marker_map))
    assert capture.up_axis == axis
    upright = joint_world(capture.skeleton, capture.poses)[0]
    assert (upright[:, capture.skeleton.index("Head"), 2] > upright[:, capture.skeleton.index("LeftFoot"), 2] + 1).all()


def test_frames_without_a_body_are_no_part_of_the_motion(captures: Path) -> None:
    capture = load_capture(captures / "c3d" / "btk_Gait_dec_int.c3d")
    trial = capture.markers.trial
    seen = np.isfinite(trial.track("LASI")).all(axis=1) & np.isfinite(trial.track("VSAC")).all(axis=1)
    assert seen[capture.first_frame]
    assert not seen[: capture.first_frame].any()
    assert capture.frame_count == len(seen) - int(np.argmax(seen[::-1]))


def test_steps_are_done_anew_on_the_trial_that_was_kept(captures: Path) -> None:
    capture = load_capture(captures / "c3d" / "btk_PiG_LowerBody_walk.c3d")
    smooth = capture_of_take(capture.markers.with_steps((*capture.markers.steps, LowPass(cutoff=3.0))), GUESS_ALL)
    again = capture_of_take(smooth.markers.with_steps(capture.markers.steps), GUESS_ALL)
    assert same(smooth.markers.trial, capture.markers.trial)
    assert not np.allclose(smooth.poses.local_translations, capture.poses.local_translations)
    assert np.array_equal(again.poses.local_rotations, capture.poses.local_rotations)


def test_a_project_keeps_trial_map_and_steps(captures: Path, tmp_path: Path) -> None:
    capture = load_capture(captures / "c3d" / "btk_shd01_prefix.c3d")
    write_project(tmp_path / "p.studio", Project(captures={"a": capture}), "0" * 32)
    opened = read_project(tmp_path / "p.studio")
    assert not opened.problems
    back = opened.project.captures["a"].markers
    assert same(back.trial, capture.markers.trial)
    assert (back.marker_map, back.steps, back.subject) == (
        capture.markers.marker_map,
        capture.markers.steps,
        capture.markers.subject,
    )


@pytest.mark.parametrize("option", [{"unit": "cmu"}, {"up_axis": "Q"}, {"reference": "99999"}])
def test_an_option_that_does_not_fit_is_refused(captures: Path, option: dict[str, str]) -> None:
    with pytest.raises(StudioError, match="Choose"):
        load_capture(captures / "c3d" / "btk_PiG_LowerBody_walk.c3d", ImportOptions(**option))


@pytest.mark.parametrize("name", ["accad_male2_G2_FrontKick", "cmu_max_jumping_jacks", "geno_bind_6ch"])
def test_virtual_markers_are_read_back_equal_and_make_the_same_body(captures: Path, tmp_path: Path, name: str) -> None:
    [path] = (captures / "bvh").rglob(f"{name}.bvh")
    capture = load_capture(path)
    write_take(take_of_capture(capture), tmp_path / "take.c3d")
    read = read_c3d(tmp_path / "take.c3d").trial
    positions = joint_world(capture.skeleton, capture.poses)[0][capture.first_frame :]
    for joint, label in enumerate(capture.skeleton.names):
        np.testing.assert_allclose(read.track(label) @ FILE_AXES["Z"].T / 1000.0, positions[:, joint], atol=1e-6)
    again = load_capture(tmp_path / "take.c3d")
    assert again.body_map is not None
    assert again.markers.marker_map.name == "Morpho Studio"
    assert max(centre_errors(again.markers).values()) < 1e-5


@pytest.mark.parametrize("suffix", [".bvh", ".s4d", ".glb", ".c3d"])
def test_a_body_that_is_written_and_read_faces_where_it_did(captures: Path, tmp_path: Path, suffix: str) -> None:
    [path] = (captures / "bvh").rglob("accad_male2_G8_RoundhouseLeft.bvh")
    capture = load_capture(path)
    write_take(take_of_capture(capture), tmp_path / f"take{suffix}")
    again = load_capture(tmp_path / f"take{suffix}")
    (before, own), (after, found) = (
        (joint_positions(each.skeleton, each.poses), each.body_map.parts) for each in (capture, again)
    )
    for part in (BodyPart.LEFT_UPPER_ARM, BodyPart.RIGHT_UPPER_ARM, BodyPart.LEFT_FOOT, BodyPart.RIGHT_FOOT):
        np.testing.assert_allclose(after[:, found[part]], before[capture.first_frame :, own[part]], atol=0.03)


def test_a_failed_export_leaves_nothing(tmp_path: Path) -> None:
    trial, _ = made_trial()
    with pytest.raises(StudioError):
        write_c3d(tmp_path / "none" / "take.c3d", trial)
    assert not list(tmp_path.iterdir())


def test_contacts_become_events(captures: Path) -> None:
    from studio.core.captures.contacts import BODY_POINTS, ContactInterval, ContactPoint

    [path] = (captures / "bvh").rglob("accad_male2_G2_FrontKick.bvh")
    contacts = [
        ContactInterval("m", ContactPoint.LEFT_HEEL, 10, 20),
        ContactInterval("m", ContactPoint.RIGHT_TOE, 5, 40),
    ]
    contacts += [ContactInterval("m", point, 8, 30) for point in BODY_POINTS]
    events = virtual_trial(load_capture(path), contacts).events
    assert [(event.context, event.label) for event in events] == [("Left", "Foot Strike"), ("Right", "Foot Off")]
    assert events[1].time == pytest.approx(40 / 30)


@pytest.mark.parametrize("name", ["btk_PiG_FullBody_walk", "btk_PiG_LowerBody_walk"])
def test_feet_are_seen_to_strike_and_to_leave_when_the_file_says_so(captures: Path, name: str) -> None:
    """The operator marked these events by the force plates and by eye; contacts are found from the solved feet."""
    path = captures / "c3d" / f"{name}.c3d"
    read = read_capture(path)
    capture = read.capture
    known = known_of_motion(capture, read.annotations, "m")
    near = 0.12 * capture.frame_rate
    for label in known.labels:
        side, what = label.name.split(" ", 1)
        point, end = ("heel", "first") if what == "Foot Strike" else ("toe", "last")
        found = [getattr(each, end) for each in known.contacts if each.point == f"{side.lower()}_{point}"]
        at_the_edge = label.first < near or label.first > capture.frame_count - near
        assert at_the_edge or min(abs(frame - label.first) for frame in found) < near, label
    assert len(known.labels) == 12
