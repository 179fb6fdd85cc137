"""Impossible physical numbers are refused wherever they come in."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedPlace
from studio.core.errors import StudioError
from studio.core.grounds import HeightMap, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.stage.clip import Clip
from studio.core.stage.project import Performer
from studio.io.importing import ImportOptions, load_capture
from tests.builders import make_capture, make_morphology
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
        lambda: ActivationCurve(0.0, 1.0, 2.0, 1e300),
        lambda: KeyedPlace((0.0, 1e12), ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))),
        lambda: Clip("motion", 0, 10, start=-1e12),
        lambda: Performer("Anna", "woman", position=(1e200, 0.0)),
    ],
)
def test_a_length_and_a_time_that_cannot_be_true_are_refused(make) -> None:
    with pytest.raises(ValueError, match="cannot be true: it is at most"):
        make()


@pytest.mark.parametrize("rate", [1e-300, 1e9])
def test_a_frame_rate_that_no_camera_has_is_refused(rate: float) -> None:
    with pytest.raises(StudioError, match=r"A frame rate of .* cannot be true"):
        replace(make_capture(), frame_rate=rate)


@pytest.mark.parametrize("unit", ["300", "1e3"])
def test_a_capture_of_bones_of_kilometres_is_refused_in_a_sentence(tmp_path: Path, unit: str) -> None:
    (tmp_path / "far.bvh").write_text(bvh_text())
    with pytest.raises(StudioError, match=r"far\.bvh: A (bone|way of the root) of .* cannot be true"):
        load_capture(tmp_path / "far.bvh", ImportOptions(unit=unit))
