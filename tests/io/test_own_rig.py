"""A character's own joints: what goes out drops on the file that came in, joint by joint and vertex by vertex."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.mesh.rig import UNMOVED_JOINT
from studio.core.mesh.skin import skin_vertices
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.zero_pose import with_zero_pose
from studio.core.rotations import from_rotation_vector, multiply, normalized, rotate, to_matrix
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.core.stage.placement import Placement
from studio.io.export import skin_of, take_of_adapted, take_of_standing, write_take
from studio.io.export_options import ExportOptions
from studio.io.figure.body import NO_RIG_MESSAGE
from studio.io.importing import load_capture, load_character
from studio.io.project.character_file import bundled_characters, read_character, write_character
from studio.io.project.project_file import new_document_id, read_project, write_project
from tests.builders import make_capture, make_project
from tests.io.blender import opened_in_blender
from tests.io.character_files import Gltf
from tests.io.khronos import issues_of
from tests.io.test_fbx_take import carried

TENTH_OF_A_MILLIMETRE, HUNDREDTH_OF_A_MILLIMETRE = 1e-4, 1e-5
TWIST, PONYTAIL = "LeftForeArmTwist", "Ponytail"


def rigged_take(character):
    """A character that stands, on a rig with a root above the hips, odd axes, a twist bone and a bone of hair."""
    take = take_of_standing(character)
    skin, skeleton = skin_of(take), take.skeleton
    names = list(skeleton.names)
    fore, head = names.index("LeftForeArm"), names.index("Head")
    middle = skeleton.offsets[names.index("LeftHand")] / 2
    skeleton = Skeleton(
        (*names, TWIST, PONYTAIL),
        np.concatenate([skeleton.parents, [fore, head]]),
        np.concatenate([skeleton.offsets, [middle, [-0.1, 0.0, 0.1]]]),
        np.concatenate([skeleton.end_sites, [False, False]]),
    )
    poses = take.poses
    still = np.array([[[0.0, 0.0, 0.0, 1.0]] * 2])
    poses = PoseSequence(
        np.concatenate([poses.local_rotations, still], axis=1),
        np.concatenate([poses.local_translations, skeleton.offsets[None, -2:]], axis=1),
    )
    joints, weights = np.array(skin.joints), np.array(skin.weights)
    shared = (joints == fore) & (weights > 0.0)
    joints, weights = np.concatenate([joints, joints], axis=1), np.concatenate([weights, 0.0 * weights], axis=1)
    joints[:, 4:][shared], weights[:, 4:][shared] = len(names), weights[:, :4][shared] / 2
    weights[:, :4][shared] /= 2
    places, turns = joint_world(skeleton, poses)
    skin = replace(skin, joints=joints, weights=weights, bind_positions=places[0], bind_rotations=turns[0])
    capture = replace(
        take.capture, skeleton=skeleton, poses=poses,
        reference_rotations=np.tile(still[0, 0], (skeleton.joint_count, 1)),
    )  # fmt: skip
    odd = to_matrix(normalized(np.random.default_rng(1).normal(size=(skeleton.joint_count, 4))))
    capture = with_zero_pose(capture, odd)
    skin = replace(skin, bind_rotations=joint_world(capture.skeleton, capture.poses)[1][0])
    options = ExportOptions(root="floor")
    rigged = options.applied_to(replace(take, capture=capture, bound=skin), Path("x.fbx"))
    return replace(rigged, rest_rotations=rigged.poses.local_rotations[0])


@pytest.fixture(scope="module", params=[".fbx", ".glb"])
def original(request, tmp_path_factory):
    """The file of a character with such a rig."""
    path = tmp_path_factory.mktemp("rig") / f"hero{request.param}"
    write_take(rigged_take(bundled_characters()["adult_woman"]), path)
    return path


def take_on(character, capture):
    request = AdaptRequest(normalize_capture(capture)[0], character.morphology)
    return take_of_adapted(character.name, adapt(request, capture.first_frame), character, request)


@cache
def figure_in(path):
    """Character of a file."""
    return load_character(path).character


@cache
def moved_figure(path):
    """Take of the character of a file, moving."""
    return take_on(figure_in(path), make_capture())


def rest_world(take):
    return joint_world(take.skeleton, rest_poses(take.skeleton, take.rest_rotations))


def test_joints_names_hierarchy_and_axes_are_those_of_the_file(original):
    source = rigged_take(bundled_characters()["adult_woman"])
    take = ExportOptions().applied_to(moved_figure(original), original)
    names = take.skeleton.names
    assert set(names) == set(source.skeleton.names)
    assert {TWIST, PONYTAIL, "root"} <= set(names)
    same = [source.skeleton.names.index(name) for name in names]
    above = {name: names[parent] for name, parent in zip(names, take.skeleton.parents, strict=True) if parent >= 0}
    expected = source.skeleton
    assert above == {
        name: expected.names[parent]
        for name, parent in zip(expected.names, expected.parents, strict=True)
        if parent >= 0
    }
    (places, turns), (wanted_places, wanted_turns) = rest_world(take), rest_world(source)
    away = places[0] - wanted_places[0, same]
    assert np.abs(away - away[0]).max() < TENTH_OF_A_MILLIMETRE
    assert np.abs(turns[0] - wanted_turns[0, same]).max() < 1e-4
    assert np.abs(skin_of(take).bind_positions - places[0]).max() < 1e-9
    assert take.capture.body_map is not None


def test_the_skin_goes_where_the_studio_shows_it(original):
    character = figure_in(original)
    adapted = moved_figure(original)
    take = ExportOptions().applied_to(adapted, original)
    positions, rotations = joint_world(take.skeleton, take.poses)
    for frame in (0, 13, 29):
        shown, _ = skin_vertices(
            replace(character.skin, centres=character.skin.vertices),
            character.build, character.morphology, adapted.adapted.positions[frame], adapted.adapted.rotations[frame],
        )  # fmt: skip
        apart = np.linalg.norm(carried(skin_of(take), positions[frame], rotations[frame]) - shown, axis=1)
        assert np.quantile(apart, 0.99) < TENTH_OF_A_MILLIMETRE
        assert apart.max() < 2e-3  # the studio keeps four influences of a vertex, and bends feet at the ball


@pytest.mark.parametrize("suffix", [".fbx", ".glb", ".usd", ".bvh"])
def test_its_file_read_back_has_the_same_motion_on_the_same_joints(original, tmp_path, suffix):
    path = tmp_path / f"out{suffix}"
    take = ExportOptions().applied_to(moved_figure(original), path)
    write_take(take, path)
    if suffix == ".usd":
        from tests.io.test_usd_take import joints_at, opened

        _stage, query, *_kept = opened(path)
        assert np.abs(joints_at(query, 13) - joint_world(take.skeleton, take.poses)[0][13]).max() < 1e-5
        return
    if suffix == ".glb":
        assert issues_of(path)["numErrors"] == 0
    back = load_capture(path)
    assert set(back.skeleton.names) >= set(take.skeleton.names)
    same = [back.skeleton.index(name) for name in take.skeleton.names]
    places = joint_world(back.skeleton, back.poses)[0][:, same]
    assert np.abs(places - joint_world(take.skeleton, take.poses)[0]).max() < 2e-5


def test_its_own_root_goes_on_the_floor_below_the_hips_and_nothing_else_moves(original):
    adapted = moved_figure(original)
    usual = ExportOptions().applied_to(adapted, original)
    take = ExportOptions(root="floor").applied_to(adapted, original)
    assert take.skeleton.names == usual.skeleton.names
    (before, turned), (after, turns) = (joint_world(each.skeleton, each.poses) for each in (usual, take))
    root, hips = (take.skeleton.names.index(name) for name in ("root", "Hips"))
    assert np.abs(np.delete(after - before, root, axis=1)).max() < 1e-9
    assert np.abs(np.delete(turns - turned, root, axis=1)).max() < 1e-9
    assert np.abs(after[:, root, :2] - after[:, hips, :2]).max() < 1e-9
    assert np.abs(after[:, root, 2]).max() < 1e-9
    assert np.ptp(after[:, root, 0]) > 0.5


def test_a_character_file_and_a_project_keep_the_rig(original, tmp_path):
    character = figure_in(original)
    write_character(character, tmp_path / "hero.json")
    project = make_project(characters=1).with_entity("characters", "character 0", character)
    write_project(tmp_path / "play.studio", project, new_document_id())
    read = read_project(tmp_path / "play.studio").project.characters["character 0"]
    for back in (read_character(tmp_path / "hero.json"), read):
        for name in ("names", "parents", "positions", "rotations", "segments", "joints", "weights"):
            assert np.array_equal(getattr(back.skin.rig, name), getattr(character.skin.rig, name))
        for name in ("format", "rotation", "position", "scales", "bones"):
            assert np.array_equal(getattr(back.skin.rig.file, name), getattr(character.skin.rig.file, name))


def test_other_names_put_it_on_the_skeleton_of_the_studio(original):
    take = ExportOptions(joint_names="humanik").applied_to(moved_figure(original), original)
    assert TWIST not in take.skeleton.names
    assert "LeftForeArm" in take.skeleton.names


@pytest.mark.parametrize(
    "name", ["kaykit_barbarian_stocky.glb", "cesium_man.gltf", "joe_hanim_kick.x3dv", "vrm1_debug_robot.vrm"]
)
def test_characters_of_others_go_out_on_their_own_joints(captures, tmp_path, name):
    character = load_character(captures / "characters" / name).character
    adapted = take_on(character, make_capture())
    take = ExportOptions().applied_to(adapted, tmp_path / "out.fbx")
    rig = character.skin.rig
    assert take.skeleton.names == rig.names
    positions, rotations = joint_world(take.skeleton, take.poses)
    shown, _ = skin_vertices(
        replace(character.skin, centres=character.skin.vertices),
        character.build, character.morphology, adapted.adapted.positions[13], adapted.adapted.rotations[13],
    )  # fmt: skip
    apart = np.linalg.norm(carried(skin_of(take), positions[13], rotations[13]) - shown, axis=1)
    assert np.median(apart) < TENTH_OF_A_MILLIMETRE
    still = np.flatnonzero(rig.segments == UNMOVED_JOINT)
    at_rest, _ = rig.file.to_file(rig.positions, rig.rotations)
    assert np.abs(positions[:, still] - at_rest[still]).max(initial=0.0) < 1e-9
    write_take(take, tmp_path / "out.fbx")
    back = load_capture(tmp_path / "out.fbx")
    same = [back.skeleton.index(each) for each in take.skeleton.names]
    assert np.abs(joint_world(back.skeleton, back.poses)[0][:, same] - positions).max() < 2e-5


def test_its_animation_drops_on_the_original_in_blender(original, tmp_path):
    take = ExportOptions().applied_to(moved_figure(original), original)
    take = replace(take, capture=replace(take.capture, frame_rate=30.0))
    exported = tmp_path / f"out{original.suffix}"
    write_take(take, exported)
    frames = take.poses.frame_count
    found = opened_in_blender(original, frames=frames, rate=30.0, action_of=exported)
    source = rigged_take(bundled_characters()["adult_woman"])
    same = [take.skeleton.names.index(name) for name in source.skeleton.names]
    positions, rotations = (each[:, same] for each in joint_world(take.skeleton, take.poses))
    mesh = max(found["meshes"].values(), key=lambda each: each["vertices"].shape[1])  # another draws Blender's bones
    expected = [carried(source.bound, positions[frame], rotations[frame]) for frame in range(frames)]
    assert np.abs(mesh["vertices"] - np.array(expected)).max() < HUNDREDTH_OF_A_MILLIMETRE


def carried_take(suffix):
    """``rigged_take`` turned, beside the origin and in the floor; its root is a scaled node that is no bone.

    Skeletons of USD have bones alone, whose scale Blender does not read.
    """
    take = rigged_take(bundled_characters()["adult_woman"])
    turn, away = from_rotation_vector(np.array([0.0, 0.0, 2.0])), np.array([0.7, -0.3, -0.023])
    rotations, translations = np.array(take.poses.local_rotations), np.array(take.poses.local_translations)
    rotations[:, 0], translations[:, 0] = multiply(turn, rotations[:, 0]), rotate(turn, translations[:, 0]) + away
    skin, matrix = skin_of(take), to_matrix(turn)
    count = take.skeleton.joint_count
    skin = replace(
        skin,
        vertices=skin.vertices @ matrix.T + away, normals=skin.normals @ matrix.T,
        bind_positions=skin.bind_positions @ matrix.T + away, bind_rotations=matrix @ skin.bind_rotations,
        bind_scales=np.full(count, {".fbx": 100.0, ".glb": 0.01, ".usdc": 1.0}[suffix]), bones=np.arange(count) > 0,
    )  # fmt: skip
    skeleton = replace(take.skeleton, offsets=translations[0])
    capture = replace(take.capture, skeleton=skeleton, poses=PoseSequence(rotations, translations))
    return replace(take, capture=capture, bound=skin, rest_rotations=rotations[0])


@pytest.fixture(scope="module", params=[".fbx", ".glb", ".usdc"])
def carried_original(request, tmp_path_factory):
    """The file of a character with such a rig."""
    path = tmp_path_factory.mktemp("carried") / f"hero{request.param}"
    write_take(carried_take(request.param), path)
    return path


def in_its_file(character):
    """Position, axes, scale and kind of each joint as it rests in the character's file, by name."""
    rig = character.skin.rig
    positions, rotations = rig.file.to_file(rig.positions, rig.rotations)
    joints = zip(rig.names, positions, rotations, rig.file.scales, rig.file.bones, strict=True)
    return {name: joint for name, *joint in joints}


def test_joints_and_skin_rest_where_they_rest_in_the_file(carried_original, tmp_path):
    character = figure_in(carried_original)
    path = tmp_path / f"out{carried_original.suffix}"
    take = ExportOptions().applied_to(moved_figure(carried_original), path)
    write_take(take, path)
    expected, found = (in_its_file(each) for each in (character, load_character(path).character))
    assert set(found) == set(expected)
    for name, joint in expected.items():
        for own, back in zip(joint, found[name], strict=True):
            assert np.allclose(np.float64(back), np.float64(own), rtol=1e-6, atol=5e-6), name
    source = carried_take(carried_original.suffix).bound
    apart, _ = cKDTree(source.vertices).query(skin_of(take).vertices)
    assert apart.max() < HUNDREDTH_OF_A_MILLIMETRE


def test_its_animation_drops_on_an_original_that_a_scaled_node_carries_in_blender(carried_original, tmp_path):
    take = ExportOptions().applied_to(moved_figure(carried_original), carried_original)
    take = replace(take, capture=replace(take.capture, frame_rate=30.0))
    exported = tmp_path / f"out{carried_original.suffix}"
    write_take(take, exported)
    frames = take.poses.frame_count
    found = opened_in_blender(carried_original, frames=frames, rate=30.0, action_of=exported)
    source = carried_take(carried_original.suffix)
    same = [take.skeleton.names.index(name) for name in source.skeleton.names]
    positions, rotations = (each[:, same] for each in joint_world(take.skeleton, take.poses))
    mesh = max(found["meshes"].values(), key=lambda each: each["vertices"].shape[1])
    expected = [carried(source.bound, positions[frame], rotations[frame]) for frame in range(frames)]
    assert np.abs(mesh["vertices"] - np.array(expected)).max() < HUNDREDTH_OF_A_MILLIMETRE


def test_a_placement_on_the_stage_moves_the_body_and_not_what_is_above_its_hips(carried_original):
    adapted = moved_figure(carried_original)
    here = ExportOptions().applied_to(adapted, carried_original)
    placement = Placement((2.0, 1.0), 0.5)
    there = ExportOptions().applied_to(replace(adapted, place=placement), carried_original)
    (before, _), (after, _) = (joint_world(each.skeleton, each.poses) for each in (here, there))
    root = there.skeleton.names.index("root")
    assert np.abs(after[:, root] - before[:, root]).max() < 1e-9
    moved = np.delete(np.arange(there.skeleton.joint_count), root)
    assert np.abs(after[:, moved] - placement.to_stage(before[:, moved])).max() < 1e-9


def test_a_root_is_added_above_hips_that_only_a_node_carries(carried_original, tmp_path):
    take = moved_figure(carried_original)
    rig = take.character.skin.rig
    bones = np.arange(len(rig.names)) >= rig.names.index("Hips")
    rig = replace(rig, file=replace(rig.file, bones=bones))
    take = replace(take, character=replace(take.character, skin=replace(take.character.skin, rig=rig)))
    path = tmp_path / f"out{carried_original.suffix}"
    usual, rooted = (ExportOptions(root=root).applied_to(take, path) for root in ("", "floor"))
    assert rooted.skeleton.joint_count == usual.skeleton.joint_count + 1
    before, after = (joint_world(each.skeleton, each.poses)[0] for each in (usual, rooted))
    assert np.abs(after[:, 2:] - before[:, 1:]).max() < 1e-9
    write_take(rooted, path)
    back = load_capture(path)
    same = [back.skeleton.index(name) for name in rooted.skeleton.names[2:]]
    assert np.abs(joint_world(back.skeleton, back.poses)[0][:, same] - after[:, 2:]).max() < 2e-5


def test_in_place_its_hips_stay_and_its_root_rests(original):
    adapted = moved_figure(original)
    usual, take = (ExportOptions(root=root).applied_to(adapted, original) for root in ("", "in-place"))
    (before, turned), (after, turns) = (joint_world(each.skeleton, each.poses) for each in (usual, take))
    root, hips = (take.skeleton.names.index(name) for name in ("root", "Hips"))
    assert np.abs(after[:, root] - before[:, root]).max() < 1e-9
    assert np.abs(after[:, hips, :2] - after[0, hips, :2]).max() < 1e-9
    assert np.abs(after[..., 2] - before[..., 2]).max() < 1e-9
    assert np.abs(turns - turned).max() < 1e-9


@pytest.mark.parametrize("scale", [[-1.0, 1.0, 1.0], [1.0, 1.4, 1.0]])
def test_joints_that_cannot_be_kept_are_told_and_exported_as_the_studio_has_them(tmp_path, scale):
    made = Gltf(vrm=1)
    nodes = made.root["nodes"]
    nodes[0]["rotation"] = [0.0, 0.0, 0.1, 0.995]
    nodes.append({"name": "carrier", "children": [0], "scale": scale})
    made.root["skins"][0].pop("inverseBindMatrices")
    (tmp_path / "hero.glb").write_bytes(made.glb())
    read = load_character(tmp_path / "hero.glb")
    assert NO_RIG_MESSAGE in read.repairs
    take = ExportOptions().applied_to(take_on(read.character, make_capture()), tmp_path / "out.fbx")
    assert "LeftForeArm" in take.skeleton.names
