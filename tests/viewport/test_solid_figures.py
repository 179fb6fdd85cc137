"""Lines of solids."""

import numpy as np
import pytest

from studio.viewport.solid_figures import _capsule


@pytest.mark.parametrize("way", [(0.0, 0.0, 0.0), (0.0, 0.0, 0.3), (0.1, -0.2, 0.0), (1e-9, 0.0, 0.0)])
def test_a_capsule_of_any_direction_or_none_is_drawn_with_its_radii(way):
    begin = np.array([1.0, 2.0, 3.0])
    for ring, centre, radius in zip(_capsule(begin, begin + way, 0.1, 0.2), (begin, begin + way), (0.1, 0.2)):  # noqa: B905
        assert np.linalg.norm(ring - centre, axis=1) == pytest.approx(radius)
