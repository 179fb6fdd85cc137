"""Mannequin with the measures of a given body: the actor of a capture as a character."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from studio.core.body.morphology import FloatArray, Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.character import Character
from studio.core.mesh.skin import SkinnedMesh, fit_skin
from studio.core.rigs.embodiment import strongest_influences

_STEP = 0.045
"""Half the height over which one vertebra hands over to the next, as a fraction of stature."""


def tailored_character(name: str, colour: str, body: Morphology, patterns: Iterable[Character]) -> Character:
    """Character with exactly the measures of ``body``, in the skin of the pattern with the nearest stature."""
    pattern = min(patterns, key=lambda each: abs(np.log(each.build.stature / body.stature)))
    build, skin = _with_spine_of(body, pattern)
    return Character(name, colour, body, fit_skin(skin, build, body))


def _with_spine_of(body: Morphology, pattern: Character) -> tuple[Morphology, SkinnedMesh]:
    """Pattern's measures and skin with as many vertebrae as ``body``, at the same fractions of its own spine."""
    knots = np.vstack([np.zeros(3), np.cumsum(pattern.build.spine, axis=0)])
    places = np.interp(_arc(body.spine), _arc(pattern.build.spine), np.arange(len(knots)))
    points = np.stack([np.interp(places, np.arange(len(knots)), knots[:, axis]) for axis in range(3)], axis=1)
    build = replace(pattern.build, spine=np.diff(points, axis=0))
    weights = _rebound(pattern, build)
    segments, shares = strongest_influences(weights)
    return build, replace(pattern.skin, segments=segments.astype(np.int32), weights=shares.astype(np.float32))


def _arc(spine: FloatArray) -> FloatArray:
    """Fractions (K+1,) of the spine's length at each joint and at the neck base."""
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(spine, axis=1))])
    return np.asarray(lengths / lengths[-1])


def _rebound(pattern: Character, build: Morphology) -> FloatArray:
    """Weights (V, K'+18) of the segments of ``build``: those of the trunk by height, all others unchanged."""
    skin, old, new = pattern.skin, pattern.build.layout.spine_count, build.layout.spine_count
    dense = np.zeros((len(skin.vertices), pattern.build.layout.segment_count))
    np.put_along_axis(dense, skin.segments.astype(np.int64), skin.weights, axis=1)
    trunk = dense[:, :old].sum(axis=1)
    chest = np.divide(dense[:, old - 1], trunk, out=np.zeros_like(trunk), where=trunk > 0.0)
    chest_height = rest_pose(pattern.build)[0][old - 1, 2]
    joints = rest_pose(build)[0][:new, 2]
    over = np.clip((skin.vertices[:, 2:3] - joints) / (_STEP * build.stature), -1.0, 1.0) / 2 + 0.5
    beyond = over * over * (3.0 - 2.0 * over)
    beyond = np.where(joints <= chest_height, np.maximum(beyond, chest[:, None]), beyond)
    beyond[:, 0] = 1.0
    beyond = np.minimum.accumulate(beyond, axis=1)
    shares = beyond - np.hstack([beyond[:, 1:], np.zeros((len(beyond), 1))])
    return np.hstack([trunk[:, None] * shares, dense[:, old:]])
