"""The surface that is drawn is the ground that is stood on."""

import numpy as np
import pytest

from studio.core.grounds import Bumps, HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.stage.project import GROUND_ID
from studio.io.project.character_file import bundled_characters
from studio.viewport.ground_visual import GroundVisual, lines_of, surface_of
from studio.viewport.offscreen import render_frame
from tests.builders import make_project
from tests.viewport.standing import results_of

UNEVEN = (
    Slope(0.1, 0.2, 0.5),
    Steps(0.1, 0.17, 0.3, 6, 0.4, (0.5, 0.2)),
    Steps(0.0, -0.17, 0.3, 1),
    Bumps(0.2, 0.1),
    HeightMap(0.0, np.random.default_rng(0).normal(size=(9, 9)) / 9),
    SurfaceMesh(0.1, [[0, 0, 0.1], [2, 0, 0.4], [0, 2, 0.2]], [[0, 1, 2]]),
)


@pytest.mark.parametrize("ground", UNEVEN, ids=lambda ground: ground.kind)
def test_cells_lie_on_the_ground(ground: Ground) -> None:
    points, normals, faces = surface_of(ground)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)
    corners = points[faces[:, 1:]]
    middle = corners.mean(axis=1)
    one, other = (corners[:, k, :2] - corners[:, 0, :2] for k in (1, 2))
    seen = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) > 1e-9
    if isinstance(ground, SurfaceMesh):
        assert np.allclose(corners[-1][:3], ground.vertices + np.array([0.0, 0.0, 0.1]))
    elif isinstance(ground, Steps):
        treads = seen & (np.ptp(corners[..., 2], axis=1) < 1e-9)
        assert np.allclose(ground.height_at(middle[treads]), middle[treads, 2])
        assert treads.sum() > 20
    else:
        assert np.allclose(ground.height_at(points), points[:, 2])


@pytest.mark.parametrize("ground", UNEVEN, ids=lambda ground: ground.kind)
def test_metre_lines_lie_just_above_it(ground: Ground) -> None:
    points, colours, pairs = lines_of(ground)
    assert len(points) == len(colours)
    assert pairs.max() < len(points)
    plain = points[: -2 * 28 * ground.count] if isinstance(ground, Steps) else points
    above = plain[:, 2] - ground.height_at(plain)
    assert np.allclose(above, above[0], atol=1e-9)


def test_nothing_is_built_while_the_ground_is_the_same() -> None:
    visual = GroundVisual()
    assert visual.show(Bumps())
    assert not visual.show(Bumps())
    assert visual.show(Bumps(seed=2))
    assert visual.show(Ground())
    assert not visual.surface.GetVisibility()


def test_a_body_stands_before_its_hill_in_the_picture() -> None:
    project = make_project(characters=1).with_entity("characters", "character 0", bundled_characters()["adult_woman"])
    level = render_frame(project, results_of(project), 0.0, (320, 200))
    slope = project.with_entity("grounds", GROUND_ID, Slope(0.0, -0.3, 0.5, (1.0, 0.0)))
    picture = render_frame(slope, results_of(project), 0.0, (320, 200))
    changed = (level != picture).any(axis=-1)
    assert 0.02 < changed.mean() < 0.9
    assert picture[..., :3].max() > 100
