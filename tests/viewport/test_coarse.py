"""The coarser mesh of bodies that move: few triangles, and still the whole body."""

from threading import Event, current_thread, main_thread

import numpy as np
import pytest

from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.skin import SkinnedMesh, skin_vertices, with_grip
from studio.io.project.character_file import bundled_characters
from studio.viewport import coarse as coarse_module
from studio.viewport.bodies import BodyVisual
from studio.viewport.coarse import coarse_skin, coarse_triangles
from tests.patience import eventually

LEFT, NEAR = 0.4, 0.03


@pytest.mark.parametrize("name", list(bundled_characters()))
def test_a_coarse_body_has_few_triangles_and_ends_where_the_whole_one_does(name: str) -> None:
    skin = bundled_characters()[name].skin
    coarse = coarse_triangles(skin)
    assert len(coarse) < LEFT * len(skin.triangles)
    assert (np.diff(np.sort(coarse, axis=1), axis=1) > 0).all()
    kept = skin.vertices[np.unique(coarse)]
    for end in (np.min, np.max):
        assert end(kept, axis=0) == pytest.approx(end(skin.vertices, axis=0), abs=NEAR)


@pytest.mark.parametrize("grip", [0.0, 1.0])
@pytest.mark.parametrize("name", list(bundled_characters()))
def test_a_coarse_skin_is_where_the_whole_one_is_its_hands_too(name: str, grip: float) -> None:
    """On a body of other measures as well."""
    character = bundled_characters()[name]
    build, other = character.build, bundled_characters()["giant"].morphology
    coarse = coarse_skin(character.skin)
    kept = np.unique(coarse_triangles(character.skin))
    assert len(coarse.vertices) == len(kept) < LEFT * len(character.skin.vertices)
    for body in (build, other):
        some, whole = (
            skin_vertices(with_grip(skin, grip), build, body, *rest_pose(body), blending=character.blending)
            for skin in (coarse, character.skin)
        )
        np.testing.assert_allclose(some, np.array(whole)[:, kept], atol=1e-6)


def test_the_whole_body_is_drawn_until_its_coarse_skin_was_made_beside_the_window(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    character, let_go, threads = bundled_characters()["child"], Event(), []

    def slow(mesh: SkinnedMesh) -> SkinnedMesh:
        threads.append(current_thread())
        let_go.wait()
        return coarse_skin(mesh)

    monkeypatch.setattr(coarse_module, "coarse_skin", slow)
    body = BodyVisual(character)

    def drawn(moving: bool) -> int:
        body.coarsen(moving)
        return int(body.skin_actors[0].mapper.GetInput().GetNumberOfPoints())

    whole = len(character.skin.vertices)
    assert drawn(moving=True) == drawn(moving=True) == whole
    let_go.set()
    assert eventually(lambda: drawn(moving=True) == len(coarse_skin(character.skin).vertices))
    assert drawn(moving=False) == whole
    assert len(threads) == 1
    assert threads[0] is not main_thread()
