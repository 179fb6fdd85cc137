"""What cannot be true is refused wherever a physical number comes in."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.errors import StudioError
from studio.core.ground import Ground
from studio.core.grounds import HeightMap, SurfaceMesh
from studio.core.triangle_mesh import TriangleMesh
from studio.io.importing import ImportOptions, load_capture
from tests.builders import make_morphology
from tests.io.bvh_text import bvh_text

FAR = np.array([[0.0, 0.0, 0.0], [1e31, 0.0, 0.0], [0.0, 1.0, 0.0]])
CORNERS = np.array([[0, 1, 2]])


@pytest.mark.parametrize(
    "make",
    [
        lambda: Ground(1e308),
        lambda: HeightMap(heights=np.array([[0.0, 1e308], [0.0, 0.0]])),
        lambda: SurfaceMesh(vertices=FAR, triangles=CORNERS),
        lambda: TriangleMesh(FAR, CORNERS),
        lambda: replace(make_morphology(), neck=37_000.0),
    ],
)
def test_a_height_a_mesh_and_a_bone_that_cannot_be_true_are_refused(make) -> None:
    with pytest.raises(ValueError, match="cannot be true: it is at most"):
        make()


@pytest.mark.parametrize("unit", ["1e6", "1e9"])
def test_a_capture_of_bones_of_kilometres_is_refused_in_a_sentence(tmp_path: Path, unit: str) -> None:
    (tmp_path / "far.bvh").write_text(bvh_text())
    with pytest.raises(StudioError, match=r"far\.bvh: A (bone|way of the root) of .* cannot be true"):
        load_capture(tmp_path / "far.bvh", ImportOptions(unit=unit))
