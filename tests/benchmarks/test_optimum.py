"""The numerical optimum by which the solver is judged: right where the answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.optimum import excess
from studio.cli.bench_cases import LIMB_CHAIN, BenchCase, make_tasks, target_positions
from studio.core.grounds.ground import Ground
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

BODY = bundled_characters()["adult_woman"].morphology
WALK, CONTACTS = walk(40)
STANDING = ground_motion(WALK, BODY, CONTACTS, Ground())
TASKS = make_tasks(WALK, CONTACTS, BODY)
FRAMES = [5, 30]


def _least(task: BenchCase, constraints: tuple) -> np.ndarray:
    nothing_missed = np.zeros((len(constraints), WALK.frame_count))
    return -excess(task, constraints, STANDING, nothing_missed, FRAMES)


def test_what_an_arm_can_reach_needs_nothing():
    assert _least(TASKS[0], TASKS[0].request.constraints) == pytest.approx(0.0, abs=1e-12)


def test_an_arm_alone_misses_what_lies_beyond_its_length():
    wrist = replace(TASKS[-1].request.constraints[2], chain=LIMB_CHAIN)
    shoulder = STANDING.positions[FRAMES, BODY.layout.collar_point(1) + 1]
    spans = np.linalg.norm(target_positions(TASKS[-1], wrist)[FRAMES] - shoulder, axis=1)
    assert _least(TASKS[-1], (wrist,)) == pytest.approx(spans - BODY.arm[1].sum(), abs=1e-9)


def test_more_freedom_never_leaves_more_to_be_missed():
    balance, _, wrist = TASKS[-1].request.constraints
    wrist = replace(wrist, priority=0)
    arm, trunk, kept = (
        _least(TASKS[-1], constraints)
        for constraints in ((replace(wrist, chain=LIMB_CHAIN),), (wrist,), (balance, wrist))
    )
    assert (trunk < arm - 0.1).all()
    assert (trunk <= kept + 1e-3).all()
