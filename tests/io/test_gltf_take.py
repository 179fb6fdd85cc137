"""glTF of an adapted motion: no complaint of the Khronos validator, and the same poses and skin when read back."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.read_back import gltf_motion
from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.contacts import ContactInterval
from studio.core.mesh.appearance import Appearance, Material
from studio.core.mesh.skin import skin_vertices
from studio.core.normalized.normalize import capture_contacts, normalize_capture
from studio.core.rigs.character_skeleton import joint_points
from studio.core.rigs.joint_skin import bone_skin, character_skin
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import take_of_adapted, take_of_capture, write_take
from studio.io.gltf.accessors import Accessors
from studio.io.gltf.container import read_gltf
from studio.io.importing import load_capture, load_character
from studio.io.png import png_bytes
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_character
from tests.io.khronos import issues_of

TENTH_OF_A_MILLIMETRE = 1e-4
FILE_TO_WORLD = [2, 0, 1]


def take_on(character, capture):
    motion, _ = normalize_capture(capture)
    spans = capture_contacts(capture)
    contacts = tuple(ContactInterval("m", point, *span) for point, many in spans.items() for span in many)
    request = AdaptRequest(motion, character.morphology, contacts)
    return take_of_adapted(character.name, adapt(request, capture.first_frame), character, request)


def read_back(path):
    """Skeleton, poses, times and the file, as any reader of glTF sees them (Y up)."""
    file = read_gltf(path)
    times = Accessors(file).numbers(file.root.value["animations"][0]["samplers"][0]["input"], 1)[:, 0]
    return *gltf_motion(path), times, file


def carried(file, skeleton, poses, frame):
    """(V, 3) where linear blending of the stored skin takes its vertices, Z up."""
    accessors, root = Accessors(file), file.root.value
    attributes = root["meshes"][0]["primitives"][0]["attributes"]
    vertices, weights = accessors.numbers(attributes["POSITION"], 3), accessors.numbers(attributes["WEIGHTS_0"], 4)
    joints = accessors.indices(attributes["JOINTS_0"], 4, skeleton.joint_count)
    inverse = accessors.numbers(root["skins"][0]["inverseBindMatrices"], 16).reshape(-1, 4, 4).swapaxes(1, 2)
    positions, rotations = joint_world(skeleton, poses.frames(frame, frame))
    world = np.tile(np.eye(4), (skeleton.joint_count, 1, 1))
    world[:, :3, :3], world[:, :3, 3] = rotations[0], positions[0]
    matrices = np.einsum("vw,vwij->vij", weights, (world @ inverse)[joints])
    moved = np.einsum("vij,vj->vi", matrices[:, :3, :3], vertices) + matrices[:, :3, 3]
    return moved[:, FILE_TO_WORLD]


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
@pytest.mark.parametrize("name", ["adult_woman", "giant"])
def test_a_real_motion_on_a_bundled_character_is_valid_and_comes_back(captures, tmp_path, name, suffix):
    character = bundled_characters()[name]
    take = take_on(character, load_capture(captures / "bvh" / "strikes" / "accad_male2_G4_SpinningBackKick.bvh"))
    path = tmp_path / f"kick{suffix}"
    write_take(take, path)
    issues = issues_of(path)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"][:5]
    skeleton, poses, times, file = read_back(path)
    assert skeleton.names == take.skeleton.names
    assert times == pytest.approx(np.arange(take.poses.frame_count) / 30.0, abs=1e-5)
    points = joint_world(skeleton, poses)[0][..., FILE_TO_WORLD]
    expected = take.adapted.positions[:, list(joint_points(character.morphology.layout))]
    assert np.linalg.norm(points - expected, axis=2).max() < TENTH_OF_A_MILLIMETRE
    shown, _ = skin_vertices(
        replace(character.skin, centres=character.skin.vertices),  # plain linear blending, as glTF has it
        character.build, character.morphology, take.adapted.positions[20], take.adapted.rotations[20],
    )  # fmt: skip
    assert np.linalg.norm(carried(file, skeleton, poses, 20) - shown, axis=1).max() < TENTH_OF_A_MILLIMETRE


def test_a_character_with_changed_proportions_keeps_its_fitted_skin(tmp_path):
    child = bundled_characters()["child"]
    character = replace(child, proportions=replace(child.proportions, stature=1.3, thighs=1.2))
    take = take_on(character, make_capture())
    write_take(take, tmp_path / "out.glb")
    assert issues_of(tmp_path / "out.glb")["numErrors"] == 0
    skeleton, poses, _, file = read_back(tmp_path / "out.glb")
    shown, _ = skin_vertices(
        replace(child.skin, centres=child.skin.vertices),
        child.build, character.morphology, take.adapted.positions[9], take.adapted.rotations[9],
    )  # fmt: skip
    assert np.linalg.norm(carried(file, skeleton, poses, 9) - shown, axis=1).max() < TENTH_OF_A_MILLIMETRE


def test_a_capture_is_written_with_a_figure_of_its_bones(tmp_path):
    capture = make_capture()
    write_take(take_of_capture(capture), tmp_path / "out.glb")
    issues = issues_of(tmp_path / "out.glb")
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"][:5]
    skeleton, poses, _, file = read_back(tmp_path / "out.glb")
    points = joint_world(skeleton, poses)[0][..., FILE_TO_WORLD]
    expected = joint_world(capture.skeleton, capture.poses)[0]
    assert np.linalg.norm(points - expected, axis=2).max() < TENTH_OF_A_MILLIMETRE
    near = np.linalg.norm(carried(file, skeleton, poses, 9)[:, None] - expected[9], axis=2).min(axis=1)
    assert near.max() < 0.25


def test_a_single_joint_is_valid_as_well(tmp_path):
    skeleton = Skeleton(("Prop",), np.array([-1]), np.zeros((1, 3)), np.array([False]))
    poses = PoseSequence(np.tile([0.0, 0.0, 0.0, 1.0], (3, 1, 1)), np.arange(9.0).reshape(3, 1, 3))
    still = np.array([[0.0, 0.0, 0.0, 1.0]])
    walk = make_capture(frames=3)
    capture = replace(walk, skeleton=skeleton, poses=poses, body_map=None, reference_rotations=still)
    write_take(take_of_capture(capture), tmp_path / "out.glb")
    assert issues_of(tmp_path / "out.glb")["numErrors"] == 0


def test_materials_and_textures_come_along(tmp_path):
    character = make_character()
    mesh = character.skin
    picture = np.frombuffer(png_bytes(np.full((4, 4, 4), 255, np.uint8)), np.uint8)
    kinds = np.arange(len(mesh.triangles), dtype=np.int32) % 2
    look = Appearance(
        (Material("cloth", "#FF0000", picture), Material("skin", "#00FF80", two_sided=True)),
        kinds,
        np.full((len(mesh.vertices), 2), 0.25, np.float32),
    )
    character = replace(character, skin=replace(mesh, appearance=look))
    write_take(take_on(character, make_capture()), tmp_path / "out.glb")
    issues = issues_of(tmp_path / "out.glb")
    assert issues["numErrors"] == 0, issues["messages"][:5]
    root = read_gltf(tmp_path / "out.glb").root.value
    assert [material["name"] for material in root["materials"]] == ["cloth", "skin"]
    assert root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == [1.0, 0.0, 0.0, 1.0]
    assert len(root["meshes"][0]["primitives"]) == 2
    assert "TEXCOORD_0" in root["meshes"][0]["primitives"][0]["attributes"]


@pytest.mark.parametrize("name", ["kaykit_barbarian_stocky.glb", "joe_hanim_kick.x3dv", "cesium_man.gltf"])
def test_a_character_from_elsewhere_goes_out_as_it_came_in(captures, tmp_path, name):
    character = load_character(captures / "characters" / name).character
    write_take(take_on(character, make_capture()), tmp_path / "out.glb")
    issues = issues_of(tmp_path / "out.glb")
    assert issues["numErrors"] == 0, issues["messages"][:5]


def test_a_skin_on_joints_stands_where_its_body_does():
    character = bundled_characters()["adult_woman"]
    skin = character_skin(character)
    assert np.abs(skin.weights.sum(axis=1) - 1.0).max() < 1e-12
    assert np.linalg.det(skin.bind_rotations) == pytest.approx(1.0)
    assert (skin.joints[skin.weights == 0.0] == 0).all()


def test_bones_are_closed_solids_seen_from_outside():
    capture = make_capture()
    skin = bone_skin(capture.skeleton)
    corners = skin.vertices[skin.triangles]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for solid in range(len(corners) // 8):
        faces = slice(8 * solid, 8 * solid + 8)
        middle = corners[faces].mean(axis=(0, 1))
        assert (np.einsum("fi,fi->f", outward[faces], corners[faces].mean(axis=1) - middle) > 0).all()
