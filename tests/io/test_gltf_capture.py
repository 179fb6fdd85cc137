"""Animations of glTF as captures: the studio's own come back, others move as their keys say."""

import base64
import json
import struct
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from studio.cli.main import main
from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.round_trip import round_trip
from studio.core.rotations import angle_between, slerp
from studio.io.export import take_of_capture, write_take
from studio.io.gltf.animation import AnimationTrack
from studio.io.gltf.capture import _frame_rate
from studio.io.importing import ImportOptions, load_capture, read_file
from studio.io.registry import ReadCapture, ReadCharacter
from studio.io.up_axis import turn_to_world
from studio.resources_folder import example_captures_folder
from tests.builders import make_capture

TENTH_OF_A_MILLIMETRE = 1e-4
VRM_BONES = {
    "UpperArm": "Arm", "LowerArm": "ForeArm", "Hand": "Hand",
    "UpperLeg": "UpLeg", "LowerLeg": "Leg", "Foot": "Foot", "Toes": "ToeBase",
}  # fmt: skip


def world(capture):
    return joint_world(capture.skeleton, capture.poses)[0]


@pytest.mark.parametrize("clip", ["accad_male2_G7_Capoeira", "pybvh_test3_fingers"])
def test_a_real_capture_goes_out_and_comes_in(captures, tmp_path, clip):
    [source] = (captures / "bvh").rglob(f"{clip}.bvh")
    before = load_capture(source)
    write_take(take_of_capture(before), tmp_path / "out.glb")
    after = load_capture(tmp_path / "out.glb")
    order = [after.skeleton.index(name) for name in before.skeleton.names]
    assert np.abs(world(after)[:, order] - world(before)).max() < TENTH_OF_A_MILLIMETRE
    assert after.frame_rate == before.frame_rate
    assert after.body_map.to_json(after.skeleton) == before.body_map.to_json(before.skeleton)
    assert after.floor == pytest.approx(before.floor, abs=1e-4)


def test_a_character_with_many_animations_gives_the_first_and_says_so(captures):
    capture = load_capture(captures / "characters" / "kaykit_barbarian_stocky.glb")
    assert capture.body_map is not None
    [guess] = [guess for guess in capture.guesses if guess.subject == "animation"]
    assert guess.value == "1H_Melee_Attack_Chop"
    assert "holds 76" in guess.reason
    assert np.ptp(world(capture)[:, capture.skeleton.index("hand.r")], axis=0).max() > 0.3


def test_joints_under_a_turned_root_stand_upright(captures):
    """The file turns Z up into Y up above its skin."""
    capture = load_capture(captures / "characters" / "cesium_man.gltf")
    heights = world(capture)[0, :, 2]
    assert 1.0 < np.ptp(heights) < 1.7
    assert capture.frame_count > 40


def test_joints_whose_names_say_nothing_make_a_body_by_shape(captures):
    capture = load_capture(captures / "characters" / "cesium_man.gltf")
    assert capture.body_map is not None
    assert "names of its joints are unknown" in {guess.subject: guess.reason for guess in capture.guesses}["body map"]
    assert round_trip(capture, *normalize_capture(capture)).position < TENTH_OF_A_MILLIMETRE
    feet = world(capture)[:, [capture.body_map[BodyPart.LEFT_FOOT], capture.body_map[BodyPart.RIGHT_FOOT]]]
    assert (np.ptp(feet[:, :, 2], axis=0) > 0.05).all()


def test_any_format_becomes_any_other(tmp_path):
    write_take(take_of_capture(make_capture()), tmp_path / "walk.bvh")
    ways = ["walk.bvh", "walk.s4d", "walk.glb", "again.s4d", "again.gltf", "last.bvh"]
    for source, target in pairwise(ways):
        assert main(["convert", str(tmp_path / source), str(tmp_path / target)]) == 0
    first, last = load_capture(tmp_path / "walk.bvh"), load_capture(tmp_path / "last.bvh")
    order = [last.skeleton.index(name) for name in first.skeleton.names if not name.endswith(("End", "_end"))]
    same = [first.skeleton.index(last.skeleton.names[joint]) for joint in order]
    assert np.abs(world(last)[:, order] - world(first)[:, same]).max() < TENTH_OF_A_MILLIMETRE


def test_a_unit_and_a_rate_can_be_overruled(tmp_path):
    write_take(take_of_capture(make_capture()), tmp_path / "walk.glb")
    half = load_capture(tmp_path / "walk.glb", ImportOptions(unit="0.5", frame_rate=30.0))
    assert half.frame_count == 15
    assert np.ptp(world(half)[0, :, 2]) == pytest.approx(0.5 * np.ptp(world(make_capture())[0, :, 2]), abs=1e-4)


@pytest.mark.parametrize("rate", [23.976, 29.97, 30.0, 59.94])
def test_a_rate_that_is_no_whole_number_is_not_rounded(tmp_path, rate):
    write_take(take_of_capture(make_capture(frame_rate=rate)), tmp_path / "walk.glb")
    assert load_capture(tmp_path / "walk.glb").frame_rate == pytest.approx(rate, abs=1e-3)


@pytest.mark.parametrize("axis", ["Z", "X", "-Y"])
def test_a_body_without_names_is_found_whatever_axis_is_up(tmp_path, axis):
    walk = load_capture(example_captures_folder() / "walk_turn.bvh")
    write_take(take_of_capture(walk), tmp_path / "walk.glb")
    raw = bytearray((tmp_path / "walk.glb").read_bytes())
    length = struct.unpack_from("<I", raw, 12)[0]
    root, binary = json.loads(raw[20 : 20 + length]), raw[28 + length :]
    turn = turn_to_world(axis).T @ turn_to_world("Y")
    for number, node in enumerate(root["nodes"]):
        node["name"] = f"n{number}"
        for member in ("translation", "rotation"):
            if member in node:
                node[member][:3] = (turn @ node[member][:3]).tolist()
    samplers = root["animations"][0]["samplers"]
    for accessor in {sampler["output"] for sampler in samplers}:
        about = root["accessors"][accessor]
        start = root["bufferViews"][about["bufferView"]].get("byteOffset", 0) + about.get("byteOffset", 0)
        width = {"VEC3": 3, "VEC4": 4}[about["type"]]
        keys = np.frombuffer(binary, "<f4", about["count"] * width, start).reshape(-1, width)
        keys[:, :3] = keys[:, :3] @ turn.T
    root["buffers"][0] = {"uri": "walk.bin", "byteLength": len(binary)}
    (tmp_path / "walk.bin").write_bytes(binary)
    (tmp_path / "walk.gltf").write_text(json.dumps(root))
    found = load_capture(tmp_path / "walk.gltf")
    assert (found.up_axis, found.floor) == (axis, pytest.approx(walk.floor, abs=0.01))
    assert [np.ptp(world(each)[:, each.body_map[BodyPart.HEAD], 2]) for each in (found, walk)] == pytest.approx(
        [np.ptp(world(walk)[:, walk.body_map[BodyPart.HEAD], 2])] * 2, abs=1e-4
    )


@pytest.mark.parametrize("rate", [24.0, 30.0, 60.0])
def test_times_that_were_rounded_still_tell_the_rate(rate):
    times = np.round(np.arange(50) / rate, 2)
    tracks = [AnimationTrack(0, "translation", times, np.zeros((50, 3)), "LINEAR")]
    assert _frame_rate(tracks, ImportOptions(), []) == rate


def test_keys_are_followed_as_they_say():
    times, values = np.array([0.0, 1.0, 3.0]), np.array([[0.0, 1, 2], [4, 4, 4], [0, 0, 9]])
    at = np.array([-1.0, 0.0, 0.4, 1.0, 2.5, 9.0])
    linear = AnimationTrack(0, "translation", times, values, "LINEAR").at(at)
    assert linear == pytest.approx(np.stack([np.interp(at, times, column) for column in values.T], axis=1))
    step = AnimationTrack(0, "translation", times, values, "STEP").at(at)
    assert step[2] == pytest.approx(values[0])
    assert step[3] == pytest.approx(values[1])
    assert step[5] == pytest.approx(values[2])
    slopes = np.array([[1.0, 0, 0], [0, 2, 0], [0, 0, -1]])
    spline = AnimationTrack(0, "translation", times, np.stack([slopes, values, slopes], axis=1), "CUBICSPLINE").at(at)
    assert spline == pytest.approx(CubicHermiteSpline(times, values, slopes)(np.clip(at, 0.0, 3.0)))
    single = AnimationTrack(0, "translation", times[:1], values[:1], "LINEAR").at(at)
    assert single == pytest.approx(np.tile(values[0], (6, 1)))


def test_a_step_shows_its_own_key_though_its_time_was_rounded_up():
    times = np.float32(np.arange(200) / 30.0).astype(np.float64)
    values = np.tile(np.arange(200.0)[:, None], (1, 3))
    shown = AnimationTrack(0, "translation", times, values, "STEP").at(np.arange(200) / 30.0)
    assert np.array_equal(shown, values)


def test_a_motion_without_a_mesh_is_described_as_a_capture(tmp_path, capsys):
    def change(root):
        root.pop("meshes", None)
        for node in root["nodes"]:
            node.pop("mesh", None)

    assert main(["info", "--json", str(with_animation(tmp_path, change))]) == 0
    [record] = json.loads(capsys.readouterr().out)
    assert (record["kind"], record["frames"]) == ("skeleton", 4)
    assert record["body_map"]["left_foot"] == "LeftFoot"


def test_the_map_of_a_vrm_animation_is_read_and_joints_without_keys_stay(tmp_path):
    pairs = [(side, bone, joint) for side in ("left", "right") for bone, joint in VRM_BONES.items()]
    named = {f"{side}{bone}": f"{side.title()}{joint}" for side, bone, joint in pairs}
    named |= {"hips": "Hips", "spine": "Spine", "chest": "Chest", "neck": "Neck", "head": "Head"}

    def change(root):
        places = {node.get("name"): index for index, node in enumerate(root["nodes"])}
        bones = {bone: {"node": places[joint]} for bone, joint in named.items()}
        root["extensions"] = {"VRMC_vrm_animation": {"humanoid": {"humanBones": bones}}}
        root.pop("skins", None)
        still = {places[f"{side}{joint}"] for side in ("Left", "Right") for joint in ("ForeArm", "Hand", "ToeBase")}
        channels = root["animations"][0]["channels"]
        root["animations"][0]["channels"] = [each for each in channels if each["target"]["node"] not in still]
        for number, node in enumerate(root["nodes"]):
            node["name"] = f"n{number}"

    path = with_animation(tmp_path, change).rename(tmp_path / "walk.vrma")
    capture = load_capture(path)
    assert capture.body_map is not None
    expected = load_capture(path).skeleton
    root = json.loads(path.read_text())
    bones = root["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"]
    for part, bone in ((BodyPart.LEFT_HAND, "leftHand"), (BodyPart.RIGHT_FOOT, "rightFoot"), (BodyPart.HEAD, "head")):
        assert expected.names[capture.body_map[part]] == root["nodes"][bones[bone]["node"]]["name"]


@pytest.mark.parametrize("member", ["scale", "matrix"])
@pytest.mark.parametrize("axis", range(3))
def test_a_body_below_a_node_that_mirrors_is_mirrored(tmp_path, member, axis):
    """The mirroring was dropped in silence, and with a matrix the rotation too."""
    signs = np.where(np.arange(3) == axis, -1.0, 1.0)

    def change(root):
        values = {"scale": signs.tolist(), "matrix": np.diag([*signs, 1.0]).ravel().tolist()}
        above = set(range(len(root["nodes"]))) - {child for node in root["nodes"] for child in node.get("children", ())}
        root["nodes"].append({"name": "Mirror", member: values[member], "children": sorted(above)})
        root["scenes"] = [{"nodes": [len(root["nodes"]) - 1]}]

    plain = load_capture(with_animation(tmp_path, lambda root: None))
    options = ImportOptions(up_axis="Y", floor=plain.floor)
    mirrored = load_capture(with_animation(tmp_path, change), options)
    order = [mirrored.skeleton.index(name) for name in plain.skeleton.names]
    reflection = turn_to_world("Y") @ np.diag(signs) @ turn_to_world("Y").T
    positions, rotations = joint_world(plain.skeleton, plain.poses)
    found_positions, found_rotations = joint_world(mirrored.skeleton, mirrored.poses)
    assert np.abs(found_positions[:, order] - positions @ reflection).max() < TENTH_OF_A_MILLIMETRE
    assert np.abs(found_rotations[:, order] - reflection @ rotations @ reflection).max() < 1e-5
    assert not mirrored.repairs


def test_a_scale_that_mirrors_a_joint_for_a_while_is_repaired_and_told(tmp_path):
    def change(root):
        hips = next(index for index, node in enumerate(root["nodes"]) if node.get("name") == "Hips")
        scales = np.array([[1, 1, 1], [-1, 1, 1], [-1, 1, 1], [1, 1, 1]], "<f4")
        data = "data:application/octet-stream;base64," + base64.b64encode(scales.tobytes()).decode()
        root["buffers"].append({"byteLength": scales.nbytes, "uri": data})
        root["bufferViews"].append({"buffer": len(root["buffers"]) - 1, "byteLength": scales.nbytes})
        view = {"bufferView": len(root["bufferViews"]) - 1, "count": 4, "type": "VEC3", "componentType": 5126}
        root["accessors"].append(view)
        [animation] = root["animations"]
        animation["samplers"].append(
            {"input": animation["samplers"][0]["input"], "output": len(root["accessors"]) - 1, "interpolation": "STEP"}
        )
        target = {"node": hips, "path": "scale"}
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})

    capture = load_capture(with_animation(tmp_path, change))
    [repair] = capture.repairs
    assert repair.startswith("In 2 frames scales mirror or flatten Hips")


def with_animation(tmp_path, change):
    """The file of a capture, its JSON changed."""
    path = tmp_path / "walk.gltf"
    write_take(take_of_capture(make_capture(frames=4)), path)
    root = json.loads(path.read_text())
    change(root)
    path.write_text(json.dumps(root))
    return path


def test_a_file_of_animations_without_a_mesh_is_a_motion_and_one_with_a_mesh_a_character(tmp_path):
    def without_mesh(root):
        del root["meshes"]
        for node in root["nodes"]:
            node.pop("mesh", None)

    assert isinstance(read_file(with_animation(tmp_path, lambda root: None)), ReadCharacter)
    read = read_file(with_animation(tmp_path, without_mesh))
    assert isinstance(read, ReadCapture)
    assert read.capture.frame_count == 4


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e30])
def test_keys_without_numbers_are_filled_and_told(tmp_path, bad):
    def change(root):
        head, _, text = root["buffers"][0]["uri"].partition(",")
        content = bytearray(base64.b64decode(text))
        for sampler in root["animations"][0]["samplers"]:
            accessor = root["accessors"][sampler["output"]]
            view = root["bufferViews"][accessor["bufferView"]]
            width = {"VEC3": 12, "VEC4": 16}[accessor["type"]]
            struct.pack_into("<f", content, view.get("byteOffset", 0) + accessor.get("byteOffset", 0) + 2 * width, bad)
        root["buffers"][0]["uri"] = f"{head},{base64.b64encode(content).decode()}"

    capture = load_capture(with_animation(tmp_path, change))
    assert capture.frame_count == 4
    assert any("walk.gltf" in words and "filled from the keys around" in words for words in capture.repairs)
    whole = load_capture(with_animation(tmp_path, lambda root: None)).poses.local_rotations
    assert angle_between(capture.poses.local_rotations[[0, 1, 3]], whole[[0, 1, 3]]).max() < 1e-5
    off = angle_between(capture.poses.local_rotations[2], slerp(whole[1], whole[3], 0.5))
    assert off.max() < 1e-3


def beyond_time(root):
    accessor = root["accessors"][root["animations"][0]["samplers"][0]["input"]]
    accessor["componentType"], accessor["normalized"] = 5125, False


BAD = {
    "no animation": (lambda root: root.update(animations=[]), "holds no animation"),
    "no channel": (lambda root: root["animations"][0].update(channels=[]), "holds no animation"),
    "a sampler that is not there": (lambda root: root["animations"][0]["channels"][0].update(sampler=999), "walk.gltf"),
    "an unknown interpolation": (
        lambda root: root["animations"][0]["samplers"][0].update(interpolation="MAGIC"),
        "LINEAR, STEP or CUBICSPLINE",
    ),
    "a spline without tangents": (
        lambda root: root["animations"][0]["samplers"][0].update(interpolation="CUBICSPLINE"),
        "a value for every time",
    ),
    "times beyond belief": (beyond_time, "times that rise"),
    "times that fall": (
        lambda root: root["animations"][0]["samplers"][0].update(input=root["animations"][0]["samplers"][0]["output"]),
        "walk.gltf",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_it_is_refused_in_a_sentence(tmp_path, case):
    change, sentence = BAD[case]
    with pytest.raises(StudioError, match=sentence) as refusal:
        load_capture(with_animation(tmp_path, change))
    assert "walk.gltf" in str(refusal.value)
