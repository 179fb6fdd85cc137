"""The coarser mesh of bodies that move: few triangles, and still the whole body."""

import numpy as np
import pytest

from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.skin import gripping, skin_vertices
from studio.io.project.character_file import bundled_characters
from studio.viewport.coarse import coarse_skin, coarse_triangles

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
            skin_vertices(gripping(skin, grip), build, body, *rest_pose(body), blending=character.blending)
            for skin in (coarse, character.skin)
        )
        np.testing.assert_allclose(some, np.array(whole)[:, kept], atol=1e-6)
