"""Every shared capture becomes a capture, with the right body and every assumption listed."""

from contextlib import suppress
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.humanoid import BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.io.bvh.reader import read_bvh, write_bvh
from studio.io.importing import ImportOptions, load_capture
from tests.builders import BODY_MAP, make_poses, make_skeleton
from tests.captures import CAPTURES
from tests.io.seeds import SEEDS

FILES = sorted((CAPTURES / "bvh").rglob("*.bvh"))
NO_HUMAN = "pybvh_rotation_first_root"
HUMANS = [path for path in FILES if path.stem != NO_HUMAN]


@lru_cache(maxsize=len(FILES) or None)
def _loaded(path: Path) -> Capture:
    return load_capture(path)


def _named(captures: Path, stem: str) -> Capture:
    return _loaded(next((captures / "bvh").rglob(f"{stem}.bvh")))


def _points(capture: Capture, positions: np.ndarray, part: str) -> np.ndarray:
    """The joint of a part, the middle of both where it has sides."""
    assert capture.body_map is not None
    names = [part] if part in ("PELVIS", "HEAD", "NECK") else [f"LEFT_{part}", f"RIGHT_{part}"]
    return np.mean([positions[..., capture.body_map[BodyPart[name]], :] for name in names], axis=0)


def _guess(capture: Capture, subject: str) -> str:
    return next((guess.value for guess in capture.guesses if guess.subject == subject), "")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_it_loads_with_sensible_values(path: Path) -> None:
    capture = _loaded(path)
    assert capture.source == path.name
    assert 20 <= capture.frame_rate <= 120
    assert -0.3 < capture.floor < 0.1
    assert {"unit", "up axis", "body map", "floor", "reference pose"} <= {guess.subject for guess in capture.guesses}
    assert all(guess.reason.endswith(".") and guess.confidence for guess in capture.guesses)
    assert (capture.body_map is None) == (path.stem == NO_HUMAN)


@pytest.mark.parametrize("path", HUMANS, ids=lambda path: path.stem)
def test_its_body_has_human_measures(path: Path) -> None:
    capture = _loaded(path)
    assert capture.body_map is not None
    positions = joint_world(capture.skeleton, capture.poses)[0][capture.first_frame :: 10]
    for bones, shortest, longest in (("THIGH SHANK FOOT", 0.7, 1.0), ("UPPER_ARM FOREARM HAND", 0.38, 0.65)):
        lengths = []
        for side in ("LEFT", "RIGHT"):
            joints = [positions[:, capture.body_map[BodyPart[f"{side}_{bone}"]]] for bone in bones.split()]
            spans = [np.linalg.norm(b - a, axis=1) for a, b in pairwise(joints)]
            assert all(span.std() < 1e-3 * span.mean() for span in spans)
            lengths.append(sum(span.mean() for span in spans))
        assert shortest < min(lengths) <= max(lengths) < longest
        assert max(lengths) < 1.1 * min(lengths)


@pytest.mark.parametrize("path", HUMANS, ids=lambda path: path.stem)
def test_its_reference_pose_stands_upright(path: Path) -> None:
    capture = _loaded(path)
    positions = joint_world(capture.skeleton, rest_poses(capture.skeleton, capture.reference_rotations))[0][0]
    height = {part: _points(capture, positions, part)[2] for part in ("HEAD", "PELVIS", "SHANK", "FOOT")}
    assert height["HEAD"] > height["PELVIS"] + 0.3
    assert height["PELVIS"] > height["SHANK"] + 0.2 > height["FOOT"] + 0.4
    trunk = _points(capture, positions, "UPPER_ARM") - _points(capture, positions, "THIGH")
    assert trunk[2] > 0.9 * np.linalg.norm(trunk)


STANDING = [path for path in HUMANS if not any(word in path.stem for word in ("Crawl", "Lie", "Random"))]


@pytest.mark.parametrize("path", STANDING, ids=lambda path: path.stem)
def test_its_motion_is_upright_over_its_floor(path: Path) -> None:
    capture = _loaded(path)
    positions = joint_world(capture.skeleton, capture.poses)[0][capture.first_frame :]
    heads, feet = _points(capture, positions, "HEAD"), _points(capture, positions, "FOOT")
    assert np.median(heads[:, 2] - feet[:, 2]) > 0.9
    assert np.percentile(positions[..., 2].min(axis=1), 20) - capture.floor == pytest.approx(0.02, abs=0.08)


SIDES = ("left", "right")
MASS = {part: f"Character1_{joint}" for part, joint in (BODY_MAP | {"spine_2": "Spine1"}).items()}
MAPS = {
    "cmu_135_04": {"pelvis": "hip", "spine_1": "abdomen", "spine_2": "chest", "neck": "neck", "head": "head"}
    | {
        f"{side}_{part}": f"{side[0]}{joint}"
        for side in SIDES
        for part, joint in (
            ("clavicle", "Collar"),
            ("upper_arm", "Shldr"),
            ("forearm", "ForeArm"),
            ("hand", "Hand"),
            ("thigh", "Thigh"),
            ("shank", "Shin"),
            ("foot", "Foot"),
        )
    },
    "cmu_max_jumping_jacks": {
        "pelvis": "Hips",
        "spine_1": "lowerback",
        "spine_2": "Chest",
        "spine_3": "Chest2",
    }
    | {"neck": "lowerneck", "head": "Head"}
    | {
        f"{side}_{part}": f"{side.capitalize()}{joint}"
        for side in SIDES
        for part, joint in (
            ("clavicle", "Collar"),
            ("upper_arm", "Shoulder"),
            ("forearm", "Elbow"),
            ("hand", "Wrist"),
            ("thigh", "Hip"),
            ("shank", "Knee"),
            ("foot", "Ankle"),
            ("toe", "Toe"),
        )
    },
    "accad_male2_E1_JabLeft": BODY_MAP | {"spine_1": "ToSpine", "spine_2": "Spine", "spine_3": "Spine1"},
    "pybvh_cmu_12_01_walk": BODY_MAP | {"spine_1": "LowerBack", "spine_2": "Spine", "spine_3": "Spine1"},
    "rokoko_jesse_dance": BODY_MAP | {"spine_1": "Spine", "spine_2": "Spine1", "spine_3": "Spine2"},
    "mass_kick": MASS,
    "mass_cart": MASS,
    "geno_bind_6ch": BODY_MAP | {"spine_1": "Spine", "spine_2": "Spine1", "spine_3": "Spine2", "spine_4": "Spine3"},
}


@pytest.mark.parametrize("stem", MAPS)
def test_each_family_of_names_is_mapped_right(captures: Path, stem: str) -> None:
    capture = _named(captures, stem)
    assert capture.body_map is not None
    assert capture.body_map.to_json(capture.skeleton) == MAPS[stem]


def test_a_forefoot_inside_the_heel_is_no_toe(captures: Path) -> None:
    capture = _named(captures, "pybvh_test3_fingers")
    assert capture.body_map is not None
    assert capture.body_map.get(BodyPart.LEFT_TOE) is None


@pytest.mark.parametrize(
    ("stem", "unit", "up_axis", "frame_rate", "reference"),
    [
        ("accad_male2_A6_BoxLift", "cm", "Y", 120, "all frames"),
        ("bvh11_cmu131_metres", "m", "Y", 120, "zero pose"),
        ("bvhtoolbox_walk01", "cm", "Y", 24, "zero pose"),
        ("cmu_max_jumping_jacks", "cmu", "Y", 30, "zero pose"),
        ("cmu01_03_climb", "cmu", "Y", 120, "zero pose"),
        ("fair_dab_zup", "unknown", "Z", 30, "zero pose"),
        ("geno_bind_6ch", "cm", "Y", 60, "all frames"),
        ("pybvh_test1_inch_zup", "inch", "Z", 30, "zero pose"),
        ("pybvh_test3_fingers", "inch", "Z", 120, "zero pose"),
        ("rokoko_jesse_dance", "cm", "Y", 100, "all frames"),
    ],
)
def test_each_oddity_is_guessed(
    captures: Path, stem: str, unit: str, up_axis: str, frame_rate: float, reference: str
) -> None:
    capture = _named(captures, stem)
    assert (capture.unit, capture.up_axis, capture.frame_rate) == (unit, up_axis, frame_rate)
    assert _guess(capture, "reference pose").startswith(reference)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_only_files_that_snap_out_of_a_calibration_pose_begin_late(path: Path) -> None:
    capture = _loaded(path)
    snaps = path.stem.startswith(("cmu_135", "cmu_salsa", "cmu01_03", "pybvh_cmu"))
    assert (capture.first_frame > 0) == snaps
    assert bool(_guess(capture, "first frame")) == snaps


def test_positions_that_repeat_the_offsets_do_not_double_the_bones(captures: Path) -> None:
    capture = _named(captures, "geno_bind_6ch")
    assert np.allclose(capture.poses.local_translations[:, 1:], capture.skeleton.offsets[1:], atol=1e-6)


def test_a_body_that_is_no_human_says_what_is_missing(captures: Path) -> None:
    capture = _named(captures, NO_HUMAN)
    reason = next(guess.reason for guess in capture.guesses if guess.subject == "body map")
    assert "no left leg (candidates: LeftLeg)" in reason
    assert "no right arm (candidates: none)" in reason


def test_a_lying_frame_count_is_listed(captures: Path) -> None:
    assert _named(captures, "assimp_Boxing_Toes").repairs == (
        "assimp_Boxing_Toes.bvh, line 128: the file says Frames: 3069; found and read: 3070.",
    )


@pytest.mark.parametrize("stem", ["mass_backflip", "geno_bind_6ch", "pybvh_test3_fingers", "cmu_max_jumping_jacks"])
def test_a_real_capture_written_and_read_loses_nothing(captures: Path, tmp_path: Path, stem: str) -> None:
    capture = _named(captures, stem)
    write_bvh(tmp_path / "again.bvh", capture.skeleton, capture.poses, capture.frame_rate)
    again = read_bvh(tmp_path / "again.bvh")
    order = [again.skeleton.index(name) for name in capture.skeleton.names]
    positions = joint_world(again.skeleton, again.poses())[0][:, order][..., [2, 0, 1]] / 100.0
    assert np.abs(positions - joint_world(capture.skeleton, capture.poses)[0]).max() < 1e-5


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    """A human of our own, written as BVH."""
    skeleton = make_skeleton()
    write_bvh(tmp_path / "walk.bvh", skeleton, make_poses(skeleton), 60.0)
    return tmp_path / "walk.bvh"


def test_our_own_human_needs_no_captures(walk: Path) -> None:
    capture = load_capture(walk)
    assert capture.body_map is not None
    assert capture.body_map.to_json(capture.skeleton) == BODY_MAP
    assert (capture.unit, capture.up_axis, capture.frame_rate) == ("cm", "Y", 60.0)


def test_what_the_user_knows_is_not_guessed(walk: Path) -> None:
    options = ImportOptions(
        unit="inch",
        up_axis="z",
        frame_rate=50.0,
        floor=-0.25,
        body_map=BODY_MAP | {"head": "Neck"},
        reference="3",
    )
    capture = load_capture(walk, options)
    assert capture.guesses == ()
    assert (capture.unit, capture.up_axis, capture.frame_rate, capture.floor) == ("inch", "Z", 50.0, -0.25)
    assert capture.body_map is not None
    assert capture.skeleton.names[capture.body_map[BodyPart.HEAD]] == "Neck"
    assert np.array_equal(capture.reference_rotations, capture.poses.local_rotations[3])
    in_cm = load_capture(walk, ImportOptions(up_axis="Z"))
    assert np.allclose(capture.skeleton.offsets, 2.54 * in_cm.skeleton.offsets)


def test_a_unit_may_be_a_number_of_metres(walk: Path) -> None:
    doubled = load_capture(walk, ImportOptions(unit="0.02"))
    assert np.allclose(doubled.skeleton.offsets, 2.0 * load_capture(walk).skeleton.offsets)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (ImportOptions(unit="furlong"), "'furlong' is not a number"),
        (ImportOptions(unit="0"), "A unit is 1e-06 to 1000 m long, not 0 m"),
        (ImportOptions(unit="1e-300"), "A unit is 1e-06 to 1000 m long, not 1e-300 m"),
        (ImportOptions(unit="1e9"), "A unit is 1e-06 to 1000 m long, not 1e9 m"),
        (ImportOptions(reference="9" * 5000), "is not a reference pose"),
        (ImportOptions(up_axis="W"), "'W' is not an up axis. Choose Y, Z, X"),
        (ImportOptions(reference="999"), "'999' is not a reference pose. Choose 'zero' or a frame from 0 to 29"),
        (ImportOptions(body_map={"left_foot": "Nose"}), "No joint is called 'Nose'"),
        (ImportOptions(body_map={"nose": "Head"}), "'nose' is not a part of a body"),
        (ImportOptions(body_map={"left_foot": "LeftHand"}), "With the chosen joints, no left leg"),
    ],
)
def test_options_that_do_not_fit_are_refused(walk: Path, options: ImportOptions, sentence: str) -> None:
    with pytest.raises(StudioError, match=sentence.replace(". ", r"\. ")):
        load_capture(walk, options)


@pytest.mark.parametrize("suffix", [".bvh", ".amc", ".glb"])
def test_whatever_is_chosen_makes_a_body_or_is_refused_in_a_sentence(suffix: str, tmp_path: Path) -> None:
    """Hips above each other in the chosen pose, a pelvis at the neck, and no pelvis at all were internal errors."""
    path = tmp_path / f"good{suffix}"
    SEEDS[suffix](path)
    found = load_capture(path)
    assert found.body_map is not None
    guessed = found.body_map.to_json(found.skeleton)
    chosen = [{}, *({part: name} for part in guessed for name in ("", *found.skeleton.names[::5])), {"pelvis": "neck"}]
    made = 0
    for number, change in enumerate(chosen):
        for up_axis in (None, "X"):
            options = ImportOptions(body_map=guessed | change, up_axis=up_axis, reference=("zero", "0")[number % 2])
            with suppress(StudioError):
                normalize_capture(load_capture(path, options))
                made += 1
    assert made > len(chosen) / 2


def test_progress_grows_to_the_end(walk: Path) -> None:
    shares: list[float] = []
    load_capture(walk, progress=lambda share, text: shares.append(share))
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
