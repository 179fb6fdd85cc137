"""The coarser mesh of bodies that move: few triangles, and still the whole body."""

import numpy as np
import pytest

from studio.io.character_file import bundled_characters
from studio.viewport.coarse import coarse_triangles

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
