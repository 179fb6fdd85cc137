"""Real walks up and down stairs, over slopes and bumps, on the five characters."""

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from studio.core.grounds import Bumps, Slope, Steps
from studio.core.grounds.ground import Ground
from studio.core.normalized.motion import NormalizedMotion
from studio.core.quality.metrics import acceleration_ratio, contact_quality, swing_depths
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.project.character_file import bundled_characters
from studio.resources_folder import example_captures_folder
from tests.captures import outside
from tests.real.taken import contacts_of, named, taken

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
STEMS = (
    "bvhtoolbox_walk01", "pybvh_cmu_12_01_walk", "accad_female1_B03_Walk1", "accad_female1_B15_WalkTurnAround180",
    "accad_female1_B21_PutDownBoxToWalk", "accad_female1_C20_RunToJumpToWalk", "accad_female1_C03_Run",
)  # fmt: skip
MOST_BRUSHING = {"stairs up": 0.04, "stairs down": 0.05}
"""Parts of the frames of feet in the air, of all characters, in which one is more than 2 mm below the ground; nowhere
else in any.
"""
RUNNING = "accad_female1_C03_Run", 0.035
"""Runs up a flight of steps, three at a time, and how much they brush."""
MOST_ACCELERATION = {"stairs up": 5.0, "stairs down": 4.0}
"""Ratio to its source's: who walks on the level climbs two or three steps within the time of one swing; 3 elsewhere."""
TILT = math.radians(15.0)


def _grounds(positions: np.ndarray) -> dict[str, Ground]:
    """Grounds that lie in the way of a walk whose root is at ``positions`` (F, 3)."""
    begin, way = positions[0, :2], positions[-1, :2] - positions[0, :2]
    ahead = way / np.linalg.norm(way)
    direction, left = math.atan2(ahead[1], ahead[0]), np.array([-ahead[1], ahead[0]])
    first = tuple(begin + 0.3 * ahead)
    return {
        "up": Slope(0.0, TILT, direction, tuple(begin)),
        "down": Slope(0.0, -TILT, direction, tuple(begin)),
        "across": Slope(0.0, TILT, direction + math.pi / 2, tuple(begin - 3 * left)),
        "stairs up": Steps(0.0, 0.17, 0.30, 30, direction, first),
        "stairs down": Steps(0.0, -0.17, 0.30, 30, direction, first),
        "bumps": Bumps(0.0, 0.08, 1.2, 1),
    }


@cache
def _source(path: Path) -> tuple[NormalizedMotion, AdaptedMotion, int]:
    capture, motion, actor = taken(path)
    return motion, source_motion(motion, actor), capture.first_frame


def _faults(path: Path) -> list[str]:
    """Faults of a walk on each ground and character, in words."""
    motion, source, first = _source(path)
    contacts, found = contacts_of(taken(path)[0]), []
    for where, ground in _grounds(source.positions[first:, 0]).items():
        depths = []
        for name, body in BODIES.items():
            adapted = adapt(AdaptRequest(motion, body, contacts, (), ground), first)
            depths.append(swing_depths(adapted, contacts, ground))
            quality = contact_quality(adapted, contacts, ground)
            measured = (
                ("slide mm", 1e3 * quality.slide, 1.0), ("float mm", 1e3 * quality.rise, 2.0),
                ("depth mm", 1e3 * quality.penetration, 3.0),
                ("acceleration ratio", acceleration_ratio(adapted, source), MOST_ACCELERATION.get(where, 3.0)),
            )  # fmt: skip
            found += [f"{where} on {name}: {what} {value:.2f}" for what, value, most in measured if value > most]
        brushing = float((np.array(depths) > 0.002).sum() / np.isfinite(depths).sum())
        most = MOST_BRUSHING.get(where, 0.0)
        if brushing > (RUNNING[1] if most and path.stem == RUNNING[0] else most):
            found.append(f"{where}: {100.0 * brushing:.2f} % of the frames of feet in the air below the ground")
    return found


@pytest.mark.parametrize("stem", ["walk", "turn", "run", *outside(*STEMS)])
def test_a_real_walk_holds_its_feet_on_any_ground(stem: str) -> None:
    assert _faults(named(stem)) == []


def test_the_bundled_walk_holds_its_feet_on_any_ground() -> None:
    assert _faults(example_captures_folder() / "walk_turn.bvh") == []
