"""FBX: the same body as it was, by a reader that may crash without harm."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.kinematics import joint_world
from studio.core.errors import StudioError
from studio.io.importing import ImportOptions, load_capture
from studio.io.scene import scene_reader
from studio.io.scene.capture import scene_joints
from studio.io.scene.proper_rotations import proper_rotations
from tests.builders import BODY_MAP
from tests.io.fbx_text import ORDERS, body, fbx_text

INSTEAD = r"Export the animation as BVH or GLB from the program that made it\.$"


@pytest.mark.parametrize(("scale", "armature"), [(1.0, False), (100.0, True)])
def test_its_body_is_found_and_moves_as_it_did(tmp_path: Path, scale: float, armature: bool) -> None:
    (tmp_path / "take.fbx").write_text(fbx_text(scale, armature))
    capture = load_capture(tmp_path / "take.fbx")
    assert (capture.frame_rate, capture.frame_count, capture.unit, capture.up_axis) == (30.0, 20, "cm", "Y")
    assert capture.body_map is not None
    assert capture.body_map.to_json(capture.skeleton) == BODY_MAP
    skeleton, poses = body()
    expected, places = joint_world(skeleton, poses)[0], joint_world(capture.skeleton, capture.poses)[0]
    same = [capture.skeleton.index(name) for name in skeleton.names]
    assert np.abs(places[:, same] - expected).max() < 1e-5


@pytest.mark.parametrize("beside", [("Camera",), ("Camera", "Light", "Skin"), tuple(f"Prop{k}" for k in range(40))])
def test_cameras_lights_and_skins_beside_the_body_bring_nothing_down(tmp_path: Path, beside: tuple[str, ...]) -> None:
    """A second thing beside the skeleton is read: ufbx's objects once died too early, and the process with them."""
    (tmp_path / "take.fbx").write_text(fbx_text(beside=beside))
    capture = load_capture(tmp_path / "take.fbx")
    skeleton, poses = body()
    assert capture.body_map is not None
    assert not set(beside) & set(capture.skeleton.names)
    places, expected = joint_world(capture.skeleton, capture.poses)[0], joint_world(skeleton, poses)[0]
    same = [capture.skeleton.index(name) for name in skeleton.names]
    assert np.abs(places[:, same] - expected).max() < 1e-5


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("before", [(0.0, 0.0, 0.0), (20.0, -35.0, 90.0)])
def test_joints_may_turn_in_any_order_from_axes_of_their_own(
    tmp_path: Path, order: str, before: tuple[float, float, float]
) -> None:
    (tmp_path / "take.fbx").write_text(fbx_text(order=order, before=before))
    capture = load_capture(tmp_path / "take.fbx")
    skeleton, poses = body()
    places, expected = joint_world(capture.skeleton, capture.poses)[0], joint_world(skeleton, poses)[0]
    same = [capture.skeleton.index(name) for name in skeleton.names]
    assert np.abs(places[:, same] - expected).max() < 1e-4


@pytest.mark.parametrize("bad", ["nan", "1.#IND", "-1.#IND", "-nan(ind)"])
def test_frames_without_numbers_are_filled_and_told(tmp_path: Path, bad: str) -> None:
    text = fbx_text()
    start = text.index("{ a: ", text.rindex("KeyValueFloat")) + 5
    end = text.index(" }", start)
    keys = text[start:end].split(",")
    keys[5] = bad
    (tmp_path / "take.fbx").write_text(text[:start] + ",".join(keys) + text[end:])
    capture = load_capture(tmp_path / "take.fbx")
    assert any("take.fbx, frame 5: 1 frame lacks numbers" in words for words in capture.repairs)
    skeleton, poses = body()
    places, expected = joint_world(capture.skeleton, capture.poses)[0], joint_world(skeleton, poses)[0]
    same = [capture.skeleton.index(name) for name in skeleton.names]
    whole = np.arange(poses.frame_count) != 5
    assert np.abs(places[:, same] - expected)[whole].max() < 1e-5
    around = 0.5 * (expected[4] + expected[6])
    assert np.abs(places[5, same] - around).max() < np.abs(expected[5] - around).max() + 0.01


@pytest.mark.parametrize("kind", ["without attributes", "as nulls"])
def test_joints_that_are_no_bones_are_read_where_they_hang_from_each_other(tmp_path: Path, kind: str) -> None:
    text = fbx_text()
    if kind == "as nulls":
        text = text.replace('"LimbNode"', '"Null"').replace('"Skeleton"', '"Null"')
    else:
        text = "\n".join(line for line in text.splitlines() if not line.startswith("NodeAttribute"))
    (tmp_path / "take.fbx").write_text(text)
    (tmp_path / "bones.fbx").write_text(fbx_text())
    capture, plain = load_capture(tmp_path / "take.fbx"), load_capture(tmp_path / "bones.fbx")
    assert capture.body_map == plain.body_map
    assert np.array_equal(joint_world(capture.skeleton, capture.poses)[0], joint_world(plain.skeleton, plain.poses)[0])


def test_what_the_user_knows_better_than_the_file_holds(tmp_path: Path) -> None:
    (tmp_path / "take.fbx").write_text(fbx_text())
    capture = load_capture(tmp_path / "take.fbx", ImportOptions(unit="inch", frame_rate=25.0))
    assert (capture.unit, capture.frame_rate) == ("inch", 25.0)


def instead_of_the_reader(monkeypatch: pytest.MonkeyPatch, statement: str) -> None:
    popen = subprocess.Popen
    monkeypatch.setattr(subprocess, "Popen", lambda command, **more: popen([command[0], "-c", statement], **more))


def test_a_reader_that_crashes_costs_the_import_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "take.fbx").write_text(fbx_text())
    instead_of_the_reader(monkeypatch, "import os; os.abort()")
    with pytest.raises(StudioError, match=rf"its reader crashed\. {INSTEAD}"):
        load_capture(tmp_path / "take.fbx")


def test_a_reader_that_never_ends_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "take.fbx").write_text(fbx_text())
    monkeypatch.setattr(scene_reader, "_PATIENCE", 0.5)
    instead_of_the_reader(monkeypatch, "while True: pass")
    with pytest.raises(StudioError, match="takes longer than"):
        load_capture(tmp_path / "take.fbx")


@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="open files are counted")
def test_a_reader_that_is_cancelled_leaves_nothing_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "take.fbx").write_text(fbx_text())
    instead_of_the_reader(monkeypatch, "while True: pass")
    before = len(list(Path("/proc/self/fd").iterdir()))

    def cancel(share: float, _text: str) -> None:
        if share > 0.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as cancelled:
        load_capture(tmp_path / "take.fbx", progress=cancel)
    assert len(list(Path("/proc/self/fd").iterdir())) == before, cancelled


def test_without_its_package_the_sentence_says_what_to_export(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "take.fbx").write_text(fbx_text())
    monkeypatch.setattr(scene_reader, "find_spec", lambda _name: None)
    with pytest.raises(StudioError, match=rf"read with the package 'ufbx'.*{INSTEAD}"):
        load_capture(tmp_path / "take.fbx")


@pytest.mark.parametrize("scale", [-1.0, 0.0, -0.001])
def test_a_scale_that_mirrors_or_flattens_a_joint_for_a_while_is_repaired_and_told(scale: float) -> None:
    frames = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], (9, 4, 1))
    rest = frames[0].copy()
    frames[2:5, 1, 7] = scale
    about = {"names": list("abcd"), "parents": [-1, 0, 1, 2], "frame_rate": 30.0, "unit_metres": 1.0, "up_axis": "Z"}
    arrays = {"frames": frames, "rest": rest, "about": np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)}
    file = scene_joints(arrays, Path("take.fbx"))
    assert np.isfinite(file.local_rotations).all()
    [repair] = file.repairs
    assert repair.startswith("In 3 frames scales mirror or flatten b, c, d")
    rest[1:, 7] = frames[:, 1:, 7] = -1.0
    assert scene_joints({**arrays, "frames": frames, "rest": rest}, Path("take.fbx")).repairs == ()


def test_joints_beyond_all_numbers_are_refused_in_a_sentence() -> None:
    frames = np.tile([1e200, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1e200, 1e200, 1e200], (2, 4, 1))
    about = {"names": list("abcd"), "parents": [-1, 0, 1, 2], "frame_rate": 30.0, "unit_metres": 1.0, "up_axis": "Z"}
    arrays = {"frames": frames, "rest": frames[0], "about": np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)}
    with pytest.raises(StudioError, match="farther away"):
        scene_joints(arrays, Path("take.fbx"))


def test_an_axis_that_is_next_to_nothing_is_repaired_without_a_warning() -> None:
    """NumPy's determinant divides by zero there; found among 51,000 spoilt files."""
    matrix = [
        [0.13061201578288173, -2.1354875814921655e-300, -0.26464501055920364],
        [0.001220394105109704, -1.9953267242427654e-302, 0.0003490920155548675],
        [0.3111733330715911, -5.087639023736742e-300, 0.1260924162699152],
    ]
    repaired, [told] = proper_rotations(["arm"], np.array([[matrix], [np.eye(3)]]))
    assert np.array_equal(repaired[:, 0], [np.eye(3), np.eye(3)])
    assert told.startswith("In 1 frame scales mirror or flatten arm")
