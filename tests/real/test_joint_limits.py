"""Limits of limbs on captures and on the bundled clips: kept, and no reason for a jerk."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from studio.cli.bench_cases import (
    BENCH_FOREARMS,
    LIMB_AND_TRUNK_CHAIN,
    LIMB_CHAIN,
    WHOLE_BODY_CHAIN,
    clip_of,
    make_tasks,
)
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.position import PositionConstraint
from studio.core.quality.metrics import acceleration_ratio
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, grounded_motion_of
from studio.core.solver.request import AdaptRequest
from studio.core.solver.task_assembly.tracks import Track, Tracks
from studio.io.importing import GUESS_ALL
from studio.jobs.adaptation import ready_capture
from studio.resources_folder import example_captures_folder
from tests.captures import outside
from tests.core.motions import ALWAYS
from tests.core.test_joint_limits import BODIES, _beyond
from tests.real.taken import named

CAPTURED = ("accad_male2_A6_BoxLift", "accad_female1_D3_ConversationGestures", "accad_male2_E1_JabLeft")
BUNDLED = ("reach_grasp", "walk_turn", "straight_punch", "front_kick")
MADE_FOR = ("adult_woman", "child")


@lru_cache
def _worst(path: Path, body: str) -> AdaptRequest:
    """Two wrists far out of reach, planted feet and balance."""
    return make_tasks(*clip_of(ready_capture(path, GUESS_ALL)), BODIES[body])[-1].request


def _ratio_and_excess(
    standing: GroundedMotion, wishes: tuple[PositionConstraint, ...], tracks: Tracks
) -> tuple[float, ...]:
    """(ratio, by how much limits are exceeded, ratio with limits off) of the greatest accelerations to the source's."""
    before = solve_constraints(standing, ())
    limited = solve_constraints(standing, wishes, tracks=tracks)
    free = solve_constraints(replace(standing, limited=False), wishes, tracks=tracks)
    return (
        float(acceleration_ratio(limited, before)),
        _beyond(limited, before, {0, 1}),
        float(acceleration_ratio(free, before)),
    )


def _check_worst(request: AdaptRequest) -> None:
    ratio, excess, free = _ratio_and_excess(grounded_motion_of(request), request.constraints, request.tracks)
    assert excess < 1e-6
    assert ratio < 4.2 * max(free, 1.0)


@pytest.mark.parametrize("body", MADE_FOR)
@pytest.mark.parametrize("stem", ["box_lift", "dance", *outside(*CAPTURED)])
def test_wrists_far_out_of_reach_stay_within_limits_without_a_jerk(stem: str, body: str) -> None:
    _check_worst(_worst(named(stem), body))


@pytest.mark.parametrize("body", MADE_FOR)
@pytest.mark.parametrize("name", BUNDLED)
def test_so_they_do_on_the_bundled_clips(name: str, body: str) -> None:
    _check_worst(_worst(example_captures_folder() / f"{name}.bvh", body))


def _wandering(standing: GroundedMotion, seed: int, chain: Chain) -> tuple[tuple[PositionConstraint, ...], Tracks]:
    """Places for both wrists that wander smoothly about their shoulders, in and out of reach, before and behind."""
    random, body = np.random.default_rng(seed), standing.morphology.first_frame_body
    times = np.arange(standing.motion.frame_count)[:, None] / standing.motion.frame_rate
    wishes, tracks = [], {}
    for side in range(2):
        arm, way = body.arm[side].sum(), random.normal(size=3)
        place = random.uniform(0.4, 1.6) * way / np.linalg.norm(way)
        for _ in range(3):
            phases = random.uniform(0.1, 0.5) * times + random.uniform(size=3)
            place = place + 0.25 * random.normal(size=3) * np.sin(2.0 * np.pi * phases)
        follow = FollowTracked(f"place {side}")
        tracks[follow] = Track(standing.positions[:, body.layout.collar_point(side) + 1] + arm * place, np.eye(3)[None])
        wrist = BodyPoint(BENCH_FOREARMS[side], at_end=True)
        wishes.append(PositionConstraint("motion", f"Wrist {side}", wrist, chain, 0, ALWAYS, target=follow))
    return tuple(wishes), tracks


@pytest.mark.parametrize(
    ("chain", "limited", "unlimited"),
    [(LIMB_CHAIN, 45.0, 9.0), (LIMB_AND_TRUNK_CHAIN, 180.0, 11.0), (WHOLE_BODY_CHAIN, 230.0, 11.0)],
    ids=["arm", "trunk", "root"],
)
def test_places_that_wander_about_the_shoulders_before_and_behind_cost_few_jerks(
    chain: Chain, limited: float, unlimited: float
) -> None:
    """Medians of each segment's peak beside its own in calm sources, limits on and off, as measured: no promise."""
    peaks = []
    for name in ("walk_turn", "straight_punch", "reach_grasp"):
        for body in MADE_FOR:
            standing = grounded_motion_of(_worst(example_captures_folder() / f"{name}.bvh", body))
            for seed in range(3):
                ratio, excess, free = _ratio_and_excess(standing, *_wandering(standing, seed, chain))
                assert excess < 1e-6
                peaks.append((ratio, free))
    assert np.all(np.median(peaks, axis=0) < (limited, unlimited))
