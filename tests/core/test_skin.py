"""Skins follow their bones, and enclose volumes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Proportions
from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.character import Character
from studio.core.mesh.skin import SkinnedMesh, fit_skin, segment_scales, skin_vertices
from studio.core.mesh.volume import BodyVolume, fitted_volume, usual_volume
from studio.io.project.character_file import bundled_characters
from tests.builders import make_morphology

# A skin follows its bones: laws of binding, fitting and deforming.


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


def test_a_skin_refuses_a_body_with_another_spine(character: Character):
    longer = replace(character.build, spine=np.vstack([character.build.spine, character.build.spine[:1]]))
    with pytest.raises(ValueError, match="spine"):
        fit_skin(character.skin, character.build, longer)


# The room a mesh takes up is that of its surface, however it is cut into triangles, and whatever hangs about it.


BODY = make_morphology()
POSITIONS = rest_pose(BODY)[0]
HIPS, NECK = POSITIONS[BODY.layout.hip_point(0), 2], POSITIONS[BODY.layout.neck_base, 2]


def tube(segment: int, heights: tuple[float, ...], half: float, x: float = 0.0, deep: float = 1.0) -> tuple:
    """Vertices, triangles and segments of a tube about an upright axis, of sixteen sides."""
    angles = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    rings = [np.stack([x + deep * half * np.cos(angles), half * np.sin(angles), 0 * angles + h], 1) for h in heights]
    corners = np.arange(16)
    sides = np.concatenate([
        part + 16 * level for level in range(len(heights) - 1) for part in (
            np.stack([corners, np.roll(corners, -1), corners + 16], 1),
            np.stack([np.roll(corners, -1), np.roll(corners, -1) + 16, corners + 16], 1),
        )
    ])  # fmt: skip
    return np.concatenate(rings), sides, np.full(16 * len(heights), segment)


def skin(*parts: tuple) -> SkinnedMesh:
    counts = np.cumsum([0, *(len(vertices) for vertices, _, _ in parts)])
    vertices = np.concatenate([vertices for vertices, _, _ in parts])
    triangles = np.concatenate([sides + before for (_, sides, _), before in zip(parts, counts, strict=False)])
    segments = np.zeros((len(vertices), 4))
    segments[:, 0] = np.concatenate([owners for _, _, owners in parts])
    weights = np.tile([1.0, 0.0, 0.0, 0.0], (len(vertices), 1))
    up = np.tile([0.0, 0.0, 1.0], (len(vertices), 1))
    return SkinnedMesh(vertices, up, vertices, triangles, segments, weights)


def volume_of(*parts: tuple) -> BodyVolume:
    return fitted_volume(skin(*parts), BODY, BODY)


def breadths(volume: BodyVolume) -> np.ndarray:
    """(3, 2) half breadths of the trunk at both ends of its three storeys."""
    return np.asarray(volume.places[:6:2, :, 1] + volume.radii[:6:2])


def test_a_coarse_trunk_is_as_broad_as_a_fine_one() -> None:
    below, above = HIPS - 0.2, NECK + 0.1
    coarse, fine = (volume_of(tube(0, tuple(np.linspace(below, above, rings)), 0.3)) for rings in (2, 40))
    assert breadths(coarse) == pytest.approx(0.3, rel=0.02)
    assert np.allclose(coarse.radii, fine.radii)


def test_capes_and_hanging_sleeves_are_none_of_the_trunk() -> None:
    trunk, thorax = tube(0, (HIPS - 0.2, NECK + 0.1), 0.16), BODY.layout.spine_count - 1
    cape = tube(thorax, (HIPS - 0.3, NECK), 0.5, -0.35, 0.02)
    vertices, sides, owners = tube(thorax, (HIPS, NECK), 0.05)
    sleeve = vertices + np.array([0.0, 0.4, 0.0]), sides, owners
    dressed, bare = volume_of(trunk, cape, sleeve), volume_of(trunk)
    assert np.allclose(dressed.places, bare.places)
    assert np.allclose(dressed.radii, bare.radii)


@pytest.mark.parametrize(("half", "deep"), [(0.02, 1.0), (0.2, 0.01)])
def test_a_rod_or_a_sheet_for_a_trunk_counts_as_a_usual_one(half: float, deep: float) -> None:
    thin = volume_of(tube(0, (HIPS - 0.2, NECK + 0.1), half, deep=deep))
    assert np.allclose(thin.radii[:6], usual_volume(BODY).radii[:6])


def test_brims_horns_and_long_hair_do_not_widen_the_head() -> None:
    head, at = BODY.layout.segment_of_part(BodyPart.HEAD), POSITIONS[BODY.layout.head_joint, 2]
    skull = tube(head, (at - 0.05, at + BODY.head), 0.09)
    brim = tube(head, (at + 0.9 * BODY.head, at + 0.91 * BODY.head), 0.4)
    vertices, sides, owners = tube(head, (HIPS, at + 0.1), 0.03)
    tail = vertices - np.array([0.3, 0.0, 0.0]), sides, owners
    odd, bare = volume_of(skull, brim, tail), volume_of(skull)
    assert odd.radii[6] == pytest.approx(bare.radii[6])
    assert odd.places[6, 0, 2] > -BODY.head


def test_a_body_that_is_scaled_is_as_much_thicker() -> None:
    mesh = skin(tube(0, (HIPS - 0.2, NECK + 0.1), 0.2))
    twice = replace(BODY, **{name: 2.0 * np.asarray(getattr(BODY, name)) for name in (
        "spine", "neck", "head", "collar_base", "clavicle", "arm", "hand", "hip_offset", "leg", "foot", "toe",
        "ankle_height", "toe_height", "heel_length")})  # fmt: skip
    once, doubled = (breadths(fitted_volume(mesh, BODY, body)) for body in (BODY, twice))
    assert doubled == pytest.approx(2.0 * once, rel=0.02)
