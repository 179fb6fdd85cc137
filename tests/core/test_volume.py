"""The room a mesh takes up is that of its surface, however it is cut into triangles, and whatever hangs about it."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.skin import SkinnedMesh
from studio.core.mesh.volume import BodyVolume, fitted_volume, usual_volume
from tests.builders import make_morphology

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
