"""FBX of an adapted motion: read back by ufbx and, where it is installed, by Blender, it is what was adapted."""

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.mesh.appearance import Appearance, Material
from studio.core.normalized.normalize import normalize_capture
from studio.core.rotations import angle_between, from_matrix, normalized
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import skin_of, take_of_adapted, take_of_capture, write_take
from studio.io.export_options import ExportOptions
from studio.io.fbx.euler import FBX_ORDERS, euler_curves
from studio.io.fbx.reading import FBX_READER
from studio.io.gltf.materials import hex_colour
from studio.io.importing import load_capture, load_character
from studio.io.joint_names import joint_namings
from studio.io.png import png_bytes
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_character
from tests.io.blender import opened_in_blender

HUNDREDTH_OF_A_MILLIMETRE = 1e-5
HUNDREDTH_OF_A_DEGREE = np.radians(0.01)
EXAMPLES = Path(__file__).parents[2] / "examples" / "captures"
CLIPS = ("strikes/accad_male2_G4_SpinningBackKick", "varied/accad_female1_D6_CartWheel", "varied/mass_backflip")


def take_on(character, capture):
    request = AdaptRequest(normalize_capture(capture)[0], character.morphology)
    return take_of_adapted(character.name, adapt(request, capture.first_frame), character, request)


def carried(skin, positions, rotations):
    """(V, 3) where linear blending takes the vertices of a skin in one frame."""
    turned = rotations @ np.swapaxes(skin.bind_rotations, 1, 2)
    shifts = positions - np.einsum("jik,jk->ji", turned, skin.bind_positions)
    moved = np.einsum("vwij,vj->vwi", turned[skin.joints], skin.vertices) + shifts[skin.joints]
    return np.einsum("vw,vwi->vi", skin.weights, moved)


def assert_same_motion(take, path):
    back = load_capture(path)
    assert set(back.skeleton.names) == set(take.skeleton.names)
    assert (back.frame_count, back.unit, back.up_axis) == (take.poses.frame_count, "cm", "Y")
    assert back.frame_rate == pytest.approx(take.frame_rate, rel=1e-9)
    same = [back.skeleton.index(name) for name in take.skeleton.names]
    places, turns = joint_world(back.skeleton, back.poses)
    expected_places, expected_turns = joint_world(take.skeleton, take.poses)
    assert np.linalg.norm(places[:, same] - expected_places, axis=2).max() < HUNDREDTH_OF_A_MILLIMETRE
    moving = ~take.skeleton.end_sites
    apart = angle_between(from_matrix(turns[:, same][:, moving]), from_matrix(expected_turns[:, moving]))
    assert apart.max() < HUNDREDTH_OF_A_DEGREE


@pytest.mark.parametrize("clip", CLIPS)
@pytest.mark.parametrize("name", ["adult_woman", "child", "giant"])
def test_a_real_motion_comes_back_joint_by_joint(captures, tmp_path, clip, name):
    take = take_on(bundled_characters()[name], load_capture(captures / "bvh" / f"{clip}.bvh"))
    write_take(take, tmp_path / "out.fbx")
    assert_same_motion(take, tmp_path / "out.fbx")


@pytest.mark.parametrize("rate", [23.976, 24.0, 29.97, 30.0, 59.94, 119.88, 120.0, 100.0, 7.5])
def test_every_frame_rate_comes_back(tmp_path, rate):
    take = take_of_capture(replace(make_capture(frames=9), frame_rate=rate))
    write_take(take, tmp_path / "out.fbx")
    assert_same_motion(take, tmp_path / "out.fbx")


@pytest.mark.parametrize("seed", range(4))
def test_any_rotations_and_translations_come_back(tmp_path, seed):
    random = np.random.default_rng(seed)
    capture = make_capture(frames=12)
    joints = capture.skeleton.joint_count
    turns = normalized(random.normal(size=(12, joints, 4)))
    turns[:, capture.skeleton.end_sites] = [0.0, 0.0, 0.0, 1.0]
    moves = capture.skeleton.offsets + random.normal(scale=0.1, size=(12, joints, 3))
    take = take_of_capture(replace(capture, poses=PoseSequence(turns, moves)))
    write_take(take, tmp_path / "out.fbx")
    back = load_capture(tmp_path / "out.fbx")
    same = [back.skeleton.index(name) for name in take.skeleton.names]
    apart = joint_world(back.skeleton, back.poses)[0][:, same] - joint_world(take.skeleton, take.poses)[0]
    assert np.abs(apart).max() < HUNDREDTH_OF_A_MILLIMETRE


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_angles_do_not_jump_where_a_joint_turns_all_the_way_round(axis):
    angles = np.linspace(-4.0, 4.0, 200) * np.pi
    turns = np.zeros((200, 4))
    turns[:, axis], turns[:, 3] = np.sin(angles / 2), np.cos(angles / 2)
    order, curves = euler_curves(turns)
    assert order in range(len(FBX_ORDERS))
    assert np.abs(np.diff(curves, axis=0)).max() == pytest.approx(np.degrees(angles[1] - angles[0]), abs=1e-6)


def test_the_skin_is_bound_as_it_was(tmp_path):
    character = bundled_characters()["adult_woman"]
    take = take_on(character, make_capture())
    write_take(take, tmp_path / "out.fbx")
    skin = skin_of(take)
    read = FBX_READER.read(tmp_path / "out.fbx", "figure", lambda share, text: None)
    assert np.abs(read["0 vertices"][:, [2, 0, 1]] / 100.0 - skin.vertices).max() < 1e-9
    back = load_character(tmp_path / "out.fbx")
    assert back.repairs == ()
    assert back.character.morphology.stature == pytest.approx(character.morphology.stature, abs=0.005)
    assert len(back.character.skin.triangles) == len(skin.triangles)


@pytest.mark.parametrize("key", joint_namings())
def test_joints_have_the_names_of_other_programs(tmp_path, key):
    take = take_on(make_character(), make_capture())
    path = tmp_path / "out.fbx"
    write_take(ExportOptions(joint_names=key).applied_to(take, path), path)
    back = load_capture(path)
    assert back.body_map is not None
    named = ExportOptions(joint_names=key).applied_to(take, path).capture
    assert back.body_map.to_json(back.skeleton) == named.body_map.to_json(named.skeleton)


def test_materials_and_pictures_are_in_the_file(tmp_path):
    character = make_character()
    mesh = character.skin
    picture = np.frombuffer(png_bytes(np.full((4, 4, 4), 255, np.uint8)), np.uint8)
    kinds = np.arange(len(mesh.triangles), dtype=np.int32) % 2
    places = np.random.default_rng(0).uniform(size=(len(mesh.vertices), 2)).astype(np.float32)
    look = Appearance((Material("cloth", "#FFFFFF", picture), Material("skin", "#00FF80")), kinds, places)
    write_take(take_on(replace(character, skin=replace(mesh, appearance=look)), make_capture()), tmp_path / "out.fbx")
    read = FBX_READER.read(tmp_path / "out.fbx", "figure", lambda share, text: None)
    told = json.loads(read["about"].tobytes())["meshes"][0]["materials"]
    assert [hex_colour(np.array(each["colour"])) for each in told] == ["#FFFFFF", "#00FF80"]
    assert read["0 0 picture"].tobytes() == picture.tobytes()
    assert read["0 faces"][:, 2].tolist() == kinds.tolist()
    corners = read["0 corners"].astype(int)
    assert np.abs(read["0 coordinates"][corners[:, 2]] - places[mesh.triangles.ravel()]).max() < 1e-6


def test_a_single_joint_is_a_file_as_well(tmp_path):
    skeleton = Skeleton(("Prop",), np.array([-1]), np.zeros((1, 3)), np.array([False]))
    poses = PoseSequence(np.tile([0.0, 0.0, 0.0, 1.0], (3, 1, 1)), np.arange(9.0).reshape(3, 1, 3))
    still = np.array([[0.0, 0.0, 0.0, 1.0]])
    capture = replace(make_capture(frames=3), skeleton=skeleton, poses=poses, body_map=None, reference_rotations=still)
    write_take(take_of_capture(capture), tmp_path / "out.fbx")
    assert np.abs(load_capture(tmp_path / "out.fbx").poses.local_translations - poses.local_translations).max() < 1e-6


def test_equal_motions_are_equal_files_that_end_as_the_format_has_it(tmp_path):
    take = take_on(make_character(), make_capture())
    for name in ("one.fbx", "two.fbx"):
        write_take(take, tmp_path / name)
    content = (tmp_path / "one.fbx").read_bytes()
    assert content == (tmp_path / "two.fbx").read_bytes()
    assert content.startswith(b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7400))
    assert content[-140:-136] == struct.pack("<I", 7400)
    assert len(content) % 16 == 0


def test_an_export_that_is_cancelled_leaves_nothing(tmp_path):
    def cancelled(share, text):
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_take(take_on(make_character(), make_capture()), tmp_path / "out.fbx", cancelled)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["adult_woman", "giant"])
def test_blender_shows_the_same_joints_and_the_same_skin(captures, tmp_path, name):
    take = take_on(bundled_characters()[name], load_capture(captures / "bvh" / f"{CLIPS[0]}.bvh"))
    write_take(take, tmp_path / "out.fbx")
    frames = take.poses.frame_count
    found = opened_in_blender(tmp_path / "out.fbx", frames=frames, rate=24.0)
    assert found["rate"] == take.frame_rate
    [armature], [mesh] = found["armatures"].values(), found["meshes"].values()
    positions, rotations = joint_world(take.skeleton, take.poses)
    skin = skin_of(take)
    same = [take.skeleton.names.index(bone) for bone in armature["bones"]]
    assert len(same) == take.skeleton.joint_count
    assert np.linalg.norm(armature["heads"] - positions[:, same], axis=2).max() < HUNDREDTH_OF_A_MILLIMETRE
    since_bound = rotations @ np.swapaxes(skin.bind_rotations, 1, 2)
    apart = angle_between(from_matrix(armature["rotations"]), from_matrix(since_bound[:, same]))
    assert apart.max() < HUNDREDTH_OF_A_DEGREE
    for frame in (0, frames // 2, frames - 1):
        expected = carried(skin, positions[frame], rotations[frame])
        assert np.linalg.norm(mesh["vertices"][frame] - expected, axis=1).max() < HUNDREDTH_OF_A_MILLIMETRE


@pytest.mark.parametrize("root", ["", "floor"])
def test_blender_moves_hips_that_rest_straight_above_a_root(tmp_path, root):
    """Blender connects such bones where their ends meet, and does not move a bone that is connected."""
    capture = load_capture(EXAMPLES / "front_kick.bvh")
    options = ExportOptions(root=root, end=1.0)
    take = options.applied_to(take_on(bundled_characters()["adult_woman"], capture), tmp_path / "out.fbx")
    take = replace(take, capture=replace(take.capture, frame_rate=30.0))
    write_take(take, tmp_path / "out.fbx")
    found = opened_in_blender(tmp_path / "out.fbx", frames=take.poses.frame_count, rate=30.0)
    [armature] = found["armatures"].values()
    same = [take.skeleton.names.index(bone) for bone in armature["bones"]]
    positions = joint_world(take.skeleton, take.poses)[0][:, same]
    assert np.abs(armature["heads"] - positions).max() < HUNDREDTH_OF_A_MILLIMETRE
