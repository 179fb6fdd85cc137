"""A skin follows its bones: laws of binding, fitting and deforming."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Proportions
from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.character import Character
from studio.core.mesh.skin import fit_skin, segment_scales, skin_vertices
from studio.io.project.character_file import bundled_characters


@pytest.fixture(scope="module")
def character() -> Character:
    return bundled_characters()["adult_woman"]


def bent(character: Character, part: BodyPart, degrees: float) -> tuple[np.ndarray, np.ndarray]:
    """The rest pose with one segment, and all that hangs on it in its limb, turned about its x axis."""
    positions, rotations = rest_pose(character.morphology)
    layout = character.morphology.layout
    parents, proximal, distal = layout.parent_segments(), layout.proximal_points(), layout.distal_points()
    first = layout.segment_of_part(part)
    moved = {first}
    for segment, parent in enumerate(parents):
        if parent in moved:
            moved.add(segment)
    turn = Rotation.from_rotvec(np.radians(degrees) * rotations[first][:, 0]).as_matrix()
    pivot = positions[proximal[first]].copy()
    for segment in sorted(moved):
        rotations[segment] = turn @ rotations[segment]
        positions[distal[segment]] = pivot + turn @ (positions[distal[segment]] - pivot)
    return positions, rotations


def volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = np.moveaxis(vertices[triangles].astype(float), 1, 0)
    return float(np.einsum("ti,ti->", a, np.cross(b, c)) / 6)


def twin(character: Character, positions: np.ndarray, rotations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Skinning about optimised centres, in NumPy."""
    skin, body = character.skin, character.build
    rest_positions, rest_rotations = rest_pose(body)
    origins = list(body.layout.proximal_points())
    turns = rotations @ rest_rotations.transpose(0, 2, 1)
    shifts = positions[origins] - np.einsum("sij,sj->si", turns, rest_positions[origins])
    quaternions = Rotation.from_matrix(turns).as_quat()[skin.segments]
    signs = np.where(np.einsum("vwi,vi->vw", quaternions, quaternions[:, 0]) < 0, -1, 1)
    blended = Rotation.from_quat(np.einsum("vw,vwi->vi", skin.weights * signs, quaternions))
    carried = np.einsum("vwij,vj->vwi", turns[skin.segments], skin.centres) + shifts[skin.segments]
    centres = np.einsum("vw,vwi->vi", skin.weights, carried)
    return blended.apply(skin.vertices - skin.centres) + centres, blended.apply(skin.normals)


def test_weights_of_each_vertex_sum_to_one():
    for character in bundled_characters().values():
        assert character.skin.weights.sum(axis=1) == pytest.approx(np.ones(len(character.skin.vertices)))


def test_the_rest_pose_of_the_build_gives_the_rest_vertices(character: Character):
    positions, rotations = rest_pose(character.build)
    vertices, normals = skin_vertices(character.skin, character.build, character.build, positions, rotations)
    assert vertices == pytest.approx(character.skin.vertices, abs=1e-6)
    assert normals == pytest.approx(character.skin.normals, abs=1e-6)


def test_the_kernel_equals_its_numpy_twin_in_random_poses(character: Character):
    random = np.random.default_rng(2)
    for _ in range(3):
        positions = random.normal(size=(character.build.layout.point_count, 3))
        rotations = Rotation.random(character.build.layout.segment_count, rng=random).as_matrix()
        expected = twin(character, positions, rotations)
        found = skin_vertices(character.skin, character.build, character.build, positions, rotations)
        assert found[0] == pytest.approx(expected[0], abs=1e-4)
        assert found[1] == pytest.approx(expected[1], abs=1e-4)


def test_moving_the_body_as_a_whole_moves_the_skin_as_a_whole(character: Character):
    turn = Rotation.from_rotvec([0.4, -1.9, 2.2]).as_matrix()
    positions, rotations = rest_pose(character.build)
    vertices, _ = skin_vertices(
        character.skin, character.build, character.build, positions @ turn.T + [1, 2, 3], turn @ rotations
    )
    assert vertices == pytest.approx(character.skin.vertices @ turn.T + [1, 2, 3], abs=1e-5)


def test_it_writes_in_place_and_allocates_nothing_where_buffers_are_given(character: Character):
    positions, rotations = rest_pose(character.build)
    buffers = np.zeros_like(character.skin.vertices), np.zeros_like(character.skin.vertices)
    found = skin_vertices(character.skin, character.build, character.build, positions, rotations, *buffers)
    assert found[0] is buffers[0]
    assert found[1] is buffers[1]
    assert buffers[0].any()


def test_a_body_scaled_as_a_whole_gets_the_skin_scaled_as_a_whole(character: Character):
    larger = Proportions(stature=1.25).applied_to(character.build)
    fitted = fit_skin(character.skin, character.build, larger)
    assert fitted.vertices == pytest.approx(character.skin.vertices * 1.25, abs=1e-5)
    assert fitted.normals == pytest.approx(character.skin.normals, abs=1e-4)


def test_longer_shanks_stretch_the_shanks_and_leave_the_arms_as_they_are(character: Character):
    longer = Proportions(shanks=1.4).applied_to(character.build)
    layout = longer.layout
    scales = segment_scales(character.build, longer)
    assert scales[layout.segment_of_part(BodyPart.LEFT_SHANK), 2] == pytest.approx(1.4)
    assert scales[layout.segment_of_part(BodyPart.LEFT_SHANK), 0] < 1.1
    assert scales[layout.segment_of_part(BodyPart.RIGHT_FOREARM)] == pytest.approx([1, 1, 1])
    fitted = fit_skin(character.skin, character.build, longer)
    assert np.ptp(fitted.vertices[:, 2]) == pytest.approx(longer.stature, rel=0.02)


@pytest.mark.parametrize(
    ("part", "degrees"),
    [(BodyPart.LEFT_FOREARM, 130), (BodyPart.LEFT_SHANK, 120), (BodyPart.RIGHT_THIGH, -110)],
)
def test_a_strongly_bent_joint_keeps_its_volume(character: Character, part: BodyPart, degrees: float):
    positions, rotations = bent(character, part, degrees)
    vertices, _ = skin_vertices(character.skin, character.build, character.build, positions, rotations)
    before = volume(character.skin.vertices, character.skin.triangles)
    assert volume(vertices, character.skin.triangles) == pytest.approx(before, rel=0.02)


def test_a_forearm_turned_about_its_bone_keeps_its_girth(character: Character):
    positions, rotations = rest_pose(character.build)
    forearm = character.build.layout.segment_of_part(BodyPart.LEFT_FOREARM)
    rotations[forearm] = rotations[forearm] @ Rotation.from_rotvec([0, 0, np.radians(150)]).as_matrix()
    vertices, _ = skin_vertices(character.skin, character.build, character.build, positions, rotations)
    before = volume(character.skin.vertices, character.skin.triangles)
    assert volume(vertices, character.skin.triangles) == pytest.approx(before, rel=0.01)


@pytest.mark.parametrize(
    ("member", "damage"),
    [
        ("vertices", lambda array: array[:, :2]),
        ("triangles", lambda array: array + 1_000_000),
        ("normals", lambda array: array * np.nan),
        ("segments", lambda array: array - 50),
        ("weights", lambda array: array * 0.5),
    ],
)
def test_a_damaged_member_is_refused_by_name(character: Character, member: str, damage):
    with pytest.raises(ValueError, match=member):
        replace(character.skin, **{member: damage(getattr(character.skin, member))})


def test_a_skin_refuses_a_body_with_another_spine(character: Character):
    longer = replace(character.build, spine=np.vstack([character.build.spine, character.build.spine[:1]]))
    with pytest.raises(ValueError, match="spine"):
        fit_skin(character.skin, character.build, longer)
