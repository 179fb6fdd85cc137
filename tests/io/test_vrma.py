"""VRM animations that are written: valid glTF, at rest in a T-pose on the ground, the same motion when read back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.cli.main import main
from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.core.rotations import angle_between, from_matrix
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import Take, take_of_adapted, take_of_capture, write_take
from studio.io.export_options import ExportOptions
from studio.io.gltf.container import read_gltf
from studio.io.importing import load_capture
from studio.io.project.character_file import actor_character, bundled_characters
from tests.builders import make_capture, make_morphology
from tests.io.bvh_exports import with_extras
from tests.io.khronos import issues_of

TENTH_OF_A_MILLIMETRE = 1e-4

BONES = [
    (BodyPart(f"{side}_{part}"), BodyPart(f"{side}_{above}"))
    for side in ("left", "right")
    for part, above in (("shank", "thigh"), ("foot", "shank"), ("forearm", "upper_arm"), ("hand", "forearm"))
]
"""Joints of the limbs with those above them."""


def directions(capture: Capture, part: BodyPart, above: BodyPart) -> np.ndarray:
    """(F, 3) unit vectors along a bone."""
    places = joint_world(capture.skeleton, capture.poses)[0]
    bones = places[:, capture.body_map[part]] - places[:, capture.body_map[above]]
    return bones / np.linalg.norm(bones, axis=1, keepdims=True)


def take_on(name: str, capture) -> Take:
    character, (motion, actor) = bundled_characters()[name], normalize_capture(capture)
    request = AdaptRequest(motion, character.morphology, actor=actor.morphology)
    return take_of_adapted(name, adapt(request, capture.first_frame), character, request, (capture, actor))


def check_same_motion(take: Take, path: Path, tolerance: float = TENTH_OF_A_MILLIMETRE) -> None:
    """Joints of the body stand in ``path`` where they do in ``take``, turned as there but for a constant."""
    back = load_capture(path)
    assert (back.frame_count, back.frame_rate) == (take.poses.frame_count, pytest.approx(take.frame_rate))
    places, turns = joint_world(back.skeleton, back.poses)
    expected, turned = joint_world(take.skeleton, take.poses)
    for part, joint in back.body_map.parts.items():
        own = take.capture.body_map[part]
        assert np.linalg.norm(places[:, joint] - expected[:, own], axis=1).max() < tolerance, part
        between = from_matrix(np.swapaxes(turned[:, own], 1, 2) @ turns[:, joint])
        assert np.degrees(angle_between(between, between[:1])).max() < 0.01, part
    assert set(back.body_map.parts) == set(take.capture.body_map.parts)


@pytest.mark.parametrize("name", ["child", "giant", "stocky_man"])
def test_a_motion_on_a_character_is_valid_and_comes_back(tmp_path, name):
    take, path = take_on(name, make_capture()), tmp_path / "walk.vrma"
    write_take(take, path)
    issues = issues_of(path)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"][:5]
    check_same_motion(take, path)


@pytest.mark.parametrize(
    "stem", ["rokoko_jesse_dance", "pybvh_test3_fingers", "accad_male2_G4_SpinningBackKick", "fair_dab_zup"]
)
def test_a_real_capture_is_valid_and_its_limbs_come_back(captures, tmp_path, stem):
    [source] = (captures / "bvh").rglob(f"{stem}.bvh")
    capture = load_capture(source)
    capture = replace(capture, poses=capture.poses.frames(0, min(capture.frame_count, 120) - 1))
    write_take(take_of_capture(capture), tmp_path / "walk.vrma")
    issues = issues_of(tmp_path / "walk.vrma")
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"][:5]
    back = load_capture(tmp_path / "walk.vrma")
    places, expected = (joint_world(each.skeleton, each.poses)[0] for each in (back, capture))
    hips, there = places[:, back.body_map[BodyPart.PELVIS]], expected[:, capture.body_map[BodyPart.PELVIS]]
    assert np.abs(hips - there).max() < TENTH_OF_A_MILLIMETRE
    for part, above in BONES:
        there, here = (directions(each, part, above) for each in (capture, back))
        assert np.degrees(np.arccos(np.clip(np.sum(there * here, axis=1), -1.0, 1.0))).max() < 0.5, part


def test_only_the_hips_travel_and_the_body_rests_in_a_t_pose_on_the_ground(tmp_path):
    path = tmp_path / "walk.vrma"
    write_take(take_of_capture(make_capture()), path)
    root = read_gltf(path).root.value
    bones = root["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"]
    moved = [
        each["target"]["node"] for each in root["animations"][0]["channels"] if each["target"]["path"] == "translation"
    ]
    assert moved == [bones["hips"]["node"]]
    assert "meshes" not in root
    assert not any("rotation" in node or "scale" in node for node in root["nodes"])
    places = {}
    parents = {child: parent for parent, node in enumerate(root["nodes"]) for child in node.get("children", [])}
    for bone, record in bones.items():
        place, node = np.zeros(3), record["node"]
        while node is not None:
            place += root["nodes"][node]["translation"]
            node = parents.get(node)
        places[bone] = place
    arm = places["leftHand"] - places["leftUpperArm"]
    assert arm / np.linalg.norm(arm) == pytest.approx([1.0, 0.0, 0.0], abs=0.03)  # +X is the left of who faces +Z
    assert 0.0 < min(place[1] for place in places.values()) < 0.1
    assert places["hips"][[0, 2]] == pytest.approx([0.0, 0.0])


def test_fingers_are_bones_of_the_humanoid_and_props_are_left_out(tmp_path):
    take, path = take_on("child", with_extras()), tmp_path / "walk.vrma"
    write_take(take, path)
    root = read_gltf(path).root.value
    bones = root["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"]
    assert {"leftThumbMetacarpal", "leftThumbProximal"} <= set(bones)
    assert {"Sword", "Eye", "Twist"}.isdisjoint(node["name"] for node in root["nodes"])
    check_same_motion(take, path)


def test_of_a_long_spine_three_joints_are_bones_and_everything_keeps_its_direction(tmp_path):
    actor = actor_character("Actor", make_morphology(spine_count=6))
    motion, _ = normalize_capture(make_capture())
    request = AdaptRequest(motion, actor.morphology)
    take, path = take_of_adapted("long", adapt(request), actor, request), tmp_path / "walk.vrma"
    write_take(take, path)
    back = load_capture(path)
    turns, turned = (joint_world(each.skeleton, each.poses)[1] for each in (back, take.capture))
    assert len(back.body_map.spine) == 4
    for part, joint in back.body_map.parts.items():
        between = from_matrix(np.swapaxes(turned[:, take.capture.body_map[part]], 1, 2) @ turns[:, joint])
        assert np.degrees(angle_between(between, between[:1])).max() < 0.01, part


def test_what_is_no_human_and_a_root_on_the_floor_are_refused(tmp_path):
    take = take_of_capture(make_capture(body_map=None))
    with pytest.raises(StudioError, match="has no body map"):
        write_take(take, tmp_path / "walk.vrma")
    with pytest.raises(StudioError, match="has no root joint"):
        ExportOptions(root="floor").check(tmp_path / "walk.vrma")
    assert not list(tmp_path.iterdir())


def test_the_command_line_converts_to_it(tmp_path):
    write_take(take_of_capture(make_capture()), tmp_path / "walk.bvh")
    assert main(["convert", str(tmp_path / "walk.bvh"), str(tmp_path / "walk.vrma")]) == 0
    assert load_capture(tmp_path / "walk.vrma").body_map is not None
