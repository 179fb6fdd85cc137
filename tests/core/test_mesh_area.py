"""Areas bounded by a mesh: points are kept out, in, or on the surface, smoothly."""

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.curves.activation import ActivationCurve
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.asking.area_rows import nearest_allowed_position
from studio.core.solver.request import AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
ALWAYS = ActivationCurve(-1.0, -1.0, 100.0, 100.0)
WALK, CONTACTS = walk()
seeds = st.integers(0, 2**32 - 1)


def ball(radius: float, rows: int = 24) -> TriangleMesh:
    """A sphere of triangles."""
    tilt, turn = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows + 1), indexing="ij")
    vertices = radius * np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=-1)
    wide = 2 * rows + 1
    quads = [(i * wide + j, (i + 1) * wide + j, (i + 1) * wide + j + 1, i * wide + j + 1)
             for i, j in product(range(rows), range(2 * rows))]  # fmt: skip
    return TriangleMesh(vertices.reshape(-1, 3), [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def block(x: float, y: float, z: float) -> TriangleMesh:
    """A box of twelve triangles about 0."""
    corners = np.array(list(product((-x / 2, x / 2), (-y / 2, y / 2), (-z / 2, z / 2))))
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return TriangleMesh(corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


BALL, BLOCK = ball(0.3), block(0.6, 0.4, 0.5)


def area(mesh: TriangleMesh, **more: object) -> AreaConstraint:
    return AreaConstraint("walk", "Rock", WRIST, Chain(trunk=0.5), 0, ALWAYS, shape=AreaShape.MESH, mesh=mesh, **more)  # type: ignore[arg-type]


@given(seed=seeds)
def test_places_are_those_of_the_ball(seed: int) -> None:
    centre = np.array([1.0, -2.0, 0.5])
    random = np.random.default_rng(seed)
    way = random.normal(size=3)
    way /= np.linalg.norm(way)
    away = random.uniform(0.2, 0.6)
    point, surface = centre + away * way, centre + 0.3 * way
    found = {
        side: nearest_allowed_position(area(BALL, centre=tuple(centre), heading=0.7, **more), point)
        for side, more in (("out", {}), ("in", {"inside": True}), ("on", {"on_surface": True}))
    }
    # From beyond the grid the nearest place is found by turns: on the surface, but a little aside.
    near = 0.012 if away < 0.34 else 0.06
    assert found["on"] == pytest.approx(surface, abs=near)
    assert np.linalg.norm(found["on"] - centre) == pytest.approx(0.3, abs=2e-3)
    assert found["out"] == (pytest.approx(point, abs=1e-12) if away > 0.305 else pytest.approx(surface, abs=near))
    assert found["in"] == (pytest.approx(point, abs=1e-12) if away < 0.293 else pytest.approx(surface, abs=near))


@given(seed=seeds)
def test_what_was_put_on_the_surface_stays_there(seed: int) -> None:
    point = np.random.default_rng(seed).uniform(-0.45, 0.45, 3)
    for mesh in (BALL, BLOCK):
        once = nearest_allowed_position(area(mesh, on_surface=True), point)
        assert nearest_allowed_position(area(mesh, on_surface=True), once) == pytest.approx(once, abs=1e-5)


def test_a_point_of_a_block_goes_to_the_nearest_face_as_with_a_box() -> None:
    box = AreaConstraint("walk", "Box", WRIST, Chain(), 0, ALWAYS, shape="box", size=(0.6, 0.4, 0.5))
    for point in ((0.25, 0.02, 0.01), (0.0, -0.15, 0.05), (0.05, 0.0, 0.2), (0.4, 0.1, 0.0)):
        assert nearest_allowed_position(area(BLOCK), point) == pytest.approx(
            nearest_allowed_position(box, point), abs=1e-3
        )


def test_a_place_on_the_surface_moves_smoothly_over_edges() -> None:
    path = np.stack([np.linspace(-0.4, 0.4, 801), np.full(801, 0.05), np.full(801, 0.27)], axis=1)
    places = np.array([nearest_allowed_position(area(BLOCK, on_surface=True), point) for point in path])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps.max() < 0.006


@pytest.mark.parametrize("name", ["child", "giant"])
@pytest.mark.parametrize("on_surface", [False, True])
def test_a_wrist_is_kept_out_of_or_on_a_mesh(name: str, on_surface: bool) -> None:
    body = bundled_characters()[name].morphology
    before = body_point_positions(WRIST, adapt(AdaptRequest(WALK, body, CONTACTS), 30, 30))[0]
    rock = area(ball(0.1), centre=tuple(before + np.array([0.03, 0.0, 0.05])), on_surface=on_surface)
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (rock,)), 30, 30)
    wrist = body_point_positions(WRIST, adapted)[0]
    assert np.linalg.norm(nearest_allowed_position(rock, wrist) - wrist) < 2e-4
    assert np.linalg.norm(wrist - np.array(rock.centre)) == pytest.approx(0.1, abs=2e-3)


def test_vertices_at_one_place_are_one_and_flat_triangles_are_none() -> None:
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 2, 0]]
    mesh = TriangleMesh(corners, [[0, 1, 2], [3, 5, 4], [0, 5, 6]])
    assert (len(mesh.vertices), len(mesh.triangles)) == (4, 2)
    assert mesh == TriangleMesh(mesh.vertices, mesh.triangles)
    assert hash(mesh) == hash(TriangleMesh(mesh.vertices, mesh.triangles))


@pytest.mark.parametrize(
    ("vertices", "triangles", "sentence"),
    [
        ([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]], "not finite"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]], "not a vertex"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], "with an area"),
        ([], [], "with an area"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices: list, triangles: list, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        TriangleMesh(np.array(vertices), np.array(triangles))


def test_the_shape_of_a_mesh_needs_one() -> None:
    with pytest.raises(ValueError, match=r"'Rock'.*needs one"):
        area(None)  # type: ignore[arg-type]


def test_sides_of_a_ball_are_told_apart_everywhere() -> None:
    for first, second in pairwise((0.05, 0.28, 0.32, 0.6)):
        a, b = (nearest_allowed_position(area(BALL), (0.0, r, 0.0))[1] - r for r in (first, second))
        assert (a > 0.0) == (first < 0.3)
        assert (b > 0.0) == (second < 0.3)


@pytest.mark.parametrize("margin", [0.02, 0.1])
def test_a_point_keeps_its_margin_from_a_mesh(margin: float) -> None:
    random, kept = np.random.default_rng(5), area(BALL, margin=margin)
    radius = float(np.linalg.norm(BALL.vertices, axis=1).mean())
    for point in random.uniform(-1.5 * radius, 1.5 * radius, (60, 3)):
        place, away = nearest_allowed_position(kept, point), float(np.linalg.norm(point))
        assert np.linalg.norm(place) == pytest.approx(max(away, radius + margin), abs=0.02 * radius)
