"""Scenes that users make: places on hands, feet and head, each with its own priority and short ramps.

Each constraint is 10 to 40 cm from where the motion has its point. A scene is measured with its first one, two, four
and six constraints: how sharp the result is beside its source, what it misses, what those added below change above, and
what it costs beside the *worst* row of the table. ``python -m benchmarks.scenes`` prints the rows.
"""

import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.clips import BUNDLED, REAL
from studio.cli.bench_cases import ROOT_CHAIN, WHOLE_BODY_CHAIN, clip_of, make_tasks
from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import adapt, body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.contact_release import constraint_activations
from studio.io.importing import GUESS_ALL
from studio.io.project.character_file import bundled_characters
from studio.jobs.adaptation import ADAPTED_MOTION_ID, ReadyCapture, ready_capture
from studio.resources_folder import example_captures_folder

FloatArray = NDArray[np.float64]

CAPTURES = (
    "varied/accad_female1_B03_Walk1.bvh", "varied/accad_male2_A6_BoxLift.bvh", "strikes/accad_male2_E1_JabLeft.bvh",
    "varied/accad_female1_A05_PickUpBox.bvh", "varied/accad_female1_D6_CartWheel.bvh",
)  # fmt: skip
"""A walk, a lift, a punch, a crouch, and hands that carry and are let go; beside them the bundled clips."""
LONGEST, COUNTS = 600, (1, 2, 4, 6)
RAMPS, HELD, AWAY = (0.2, 0.3), (0.3, 1.0), (0.1, 0.4)
"""Seconds of ramps, seconds held, and metres from where a point is to where it is wanted."""
_REACH, _TRUNK = Chain(), Chain(trunk=1.0)
_HEAD = Chain(limb=1.0, end_segment=1.0, clavicle=0.0, trunk=1.0)
POINTS = (
    (BodyPart.RIGHT_FOREARM, (_REACH, _TRUNK, WHOLE_BODY_CHAIN)),
    (BodyPart.LEFT_FOREARM, (_REACH, _TRUNK, WHOLE_BODY_CHAIN)),
    (BodyPart.HEAD, (_HEAD,)), (BodyPart.RIGHT_SHANK, (_REACH,)), (BodyPart.LEFT_SHANK, (_REACH,)),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Result:
    """One scene with its first ``count`` constraints: accelerations beside the source's peak, millimetres, times."""

    scene: str
    count: int
    peak: float
    exact_peak: float
    missed: float
    changed: float
    """The most that a constraint added below changed what one above misses while it acts wholly, by the pose itself."""
    ramped: float
    """The same while the one above comes or goes, of what is told: then it is missed in proportion."""
    cost: float
    """Microseconds a frame beside the *worst* row of the same clip and body."""
    exact_cost: float


def scene(standing: GroundedMotion, before: AdaptedMotion, seed: int) -> tuple[Constraint, ...]:
    """Six constraints on one motion, highest first; the last is a balance or comes back to a point."""
    random = np.random.default_rng(seed)
    picked = [*random.permutation(len(POINTS)).tolist(), int(random.integers(len(POINTS)))]
    whole = before.frame_count / before.frame_rate
    middle = random.uniform(0.3, 0.7) * whole
    made: list[Constraint] = []
    for priority, number in enumerate(picked):
        part, chains = POINTS[number]
        chain, point = chains[random.integers(len(chains))], BodyPoint(part, at_end=True)
        held, ramp = random.uniform(*HELD), random.uniform(*RAMPS)
        begin = np.clip(middle + random.uniform(-0.4, 0.4) - 0.5 * held, ramp, max(whole - held - ramp, ramp))
        times = ActivationCurve(*np.maximum.accumulate([begin - ramp, begin, begin + held, begin + held + ramp]))
        way = random.normal(size=3)
        frame = min(int((begin + 0.5 * held) * before.frame_rate), before.frame_count - 1)
        place = body_point_positions(point, before)[frame] + random.uniform(*AWAY) * way / np.linalg.norm(way)
        name = f"{priority} {part.label}"
        made.append(
            PositionConstraint(ADAPTED_MOTION_ID, name, point, chain, priority, times, target=tuple(place.tolist()))
        )
        if priority == len(picked) - 1 and random.uniform() < 0.5:
            made[-1] = BalanceConstraint(
                ADAPTED_MOTION_ID, "Balance", BodyPoint(BodyPart.PELVIS), ROOT_CHAIN, priority, times
            )
    return tuple(made)


def measure(
    name: str, standing: GroundedMotion, seed: int, worst: float, exact: bool = False, tries: int = 2
) -> list[Result]:
    """A scene with its first one, two, four and six constraints; ``worst`` microseconds a frame.

    Each is solved ``tries`` times, and the lowest cost counts.
    """
    before = solve_constraints(standing, ())
    source = max(float(angular_acceleration(before.rotations, before.frame_rate).max()), QUIET_PEAK)
    asked, results, higher = scene(standing, before, seed), [], None
    for count in COUNTS:
        plain, exact_cost = _timed(standing, asked[:count], tries, eased=False)
        solved, cost = (plain, exact_cost) if exact else _timed(standing, asked[:count], tries, eased=True)
        peak, exact_peak = (
            float(angular_acceleration(each.rotations, each.frame_rate).max()) / source for each in (solved, plain)
        )
        shares = constraint_activations(asked[:count], standing)
        misses = _misses(solved, asked[:count]), np.nan_to_num(solved.residuals)
        missed = np.where(shares >= 1.0, solved.residuals, np.nan)
        changed = ramped = 0.0
        if higher is not None:
            placed, told = (np.abs(now[: len(higher[0])] - was) for now, was in zip(misses, higher, strict=True))
            above = shares[: len(placed)]
            changed = float(np.max(placed, where=above >= 1.0, initial=0.0))
            ramped = float(np.max(told, where=(above > 0.0) & (above < 1.0), initial=0.0))
        higher = misses
        mean = float(np.nanmean(missed)) if np.isfinite(missed).any() else 0.0
        told = (1e3 * mean, 1e3 * changed, 1e3 * ramped)
        results.append(Result(f"{name} {seed}", count, peak, exact_peak, *told, cost / worst, exact_cost / worst))
    return results


def _misses(solved: AdaptedMotion, asked: Sequence[Constraint]) -> FloatArray:
    """(C, F) metres that points are off their places, by the pose itself; balances as the solver tells them."""
    return np.array(
        [
            np.linalg.norm(body_point_positions(each.point, solved) - np.array(each.target), axis=1)
            if isinstance(each, PositionConstraint)
            else np.nan_to_num(solved.residuals[number])
            for number, each in enumerate(asked)
        ]
    )


def _timed(
    standing: GroundedMotion, asked: Sequence[Constraint], tries: int, *, eased: bool
) -> tuple[AdaptedMotion, float]:
    """Solved motion, and processor microseconds a frame, the best of ``tries``."""
    costs = []
    for _ in range(tries):
        start = time.process_time()
        solved = solve_constraints(standing, asked, eased=eased)
        costs.append(1e6 * (time.process_time() - start) / solved.frame_count)
    return solved, min(costs)


def worst_cost(ready: ReadyCapture, body: str) -> float:
    """Microseconds a frame of the *worst* row on the same clip and body."""
    request = make_tasks(*clip_of(ready, LONGEST), bundled_characters()[body].morphology)[-1].request
    adapt(request)
    start = time.process_time()
    adapt(request)
    return 1e6 * (time.process_time() - start) / request.motion.frame_count


def clips() -> dict[str, ReadyCapture]:
    """The bundled clips, and real ones where they are."""
    paths = [example_captures_folder() / name for name in BUNDLED]
    paths += [REAL / name for name in CAPTURES] if REAL.is_dir() else []
    return {path.stem: ready_capture(path, GUESS_ALL) for path in paths}


def table(results: Sequence[Result]) -> str:
    """Median, 90 % and most of every count."""
    columns = "peak", "exact_peak", "missed", "changed", "ramped", "cost", "exact_cost"
    lines = ["| constraints | " + " | ".join(columns) + " |", "| --- " * (1 + len(columns)) + "|"]
    for count in COUNTS:
        rows = [each for each in results if each.count == count]
        cells = [np.percentile([getattr(row, column) for row in rows], [50, 90, 100]) for column in columns]
        lines.append(f"| {count} | " + " | ".join(" / ".join(f"{v:.3g}" for v in cell) for cell in cells) + " |")
    return "\n".join(lines)


def main(arguments: Sequence[str]) -> int:
    """Measure and print; ``--each`` every scene, and a number the seeds of each clip."""
    seeds = next((int(each) for each in arguments if each.isdigit()), 3)
    bodies, results = list(bundled_characters()), []
    for index, (name, ready) in enumerate(clips().items()):
        motion, contacts = clip_of(ready, LONGEST)
        for seed in range(seeds):
            body = bodies[(index + seed) % len(bodies)]
            standing = ground_motion(motion, bundled_characters()[body].morphology, contacts, Ground())
            found = measure(f"{name} {body}", standing, seed, worst_cost(ready, body))
            results += found
            if "--each" in arguments:
                for each in found:
                    print(each.scene, each.count, *(f"{v:.2f}" for v in list(vars(each).values())[2:]), flush=True)
    print(table(results))
    print("microseconds beside worst, six constraints:", statistics.median(r.cost for r in results if r.count == 6))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
