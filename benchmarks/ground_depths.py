"""Depth of bodies below the ground beyond that of their unconstrained motion, after constraints as users make them.

*Presses* keep a random joint where it is at a random frame, as the key C does; *far* targets are 1 to 4 m from there.
``python -m benchmarks.ground_depths`` prints both; ``--each`` every case, and a number its count of each.
"""

import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.clips import BUNDLED, REAL
from studio.cli.bench_cases import clip_of
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.fitted_activation import LimbPath, fitted_activation, free_frames
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import angular_acceleration, point_heights
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.points import limb_of
from studio.io.importing import GUESS_ALL
from studio.io.project.character_file import bundled_characters
from studio.jobs.adaptation import ADAPTED_MOTION_ID, ready_capture
from studio.resources_folder import example_captures_folder
from studio.viewport.body_points import BodyJoint, body_joints

FloatArray = NDArray[np.float64]

CAPTURES = (
    "strikes/accad_male2_G2_FrontKick.bvh", "strikes/accad_male2_G8_RoundhouseLeft.bvh",
    "varied/accad_female1_A11_CrawlForward.bvh", "varied/accad_female1_A08_CrouchToLie.bvh",
    "varied/accad_female1_A05_PickUpBox.bvh", "varied/accad_female1_B03_Walk1.bvh",
)  # fmt: skip
"""Kicks, a crawl, a body that lies down, one that crouches, and a walk; beside them the bundled clips."""
BODIES = "child", "tall_man", "giant"
LONGEST, TOLERANCE = 600, 0.005
FAR, HELD, RAMP = (1.0, 4.0), 0.5, 0.3
"""Metres of far targets from where a joint is, and seconds held and of both ramps."""


@dataclass(frozen=True)
class Result:
    """One case: millimetres below the ground, residual in its middle, and its peak beside the source's."""

    case: str
    depth: float
    part: str
    frame: int
    missed: float
    peak: float


@cache
def standing_on(name: str, body: str) -> GroundedMotion:
    """Grounded motion of a clip."""
    path = example_captures_folder() / name if name in BUNDLED else REAL / name
    ready = ready_capture(path, GUESS_ALL)
    motion, contacts = clip_of(ready, LONGEST)
    return ground_motion(
        motion, bundled_characters()[body].morphology, contacts, Ground(), actor=ready.actor.morphology, clears=True
    )


def press(standing: GroundedMotion, joint: BodyJoint, row: int) -> PositionConstraint:
    """Constraint that keeps a joint where it is at a frame."""
    before, rate = solve_constraints(standing, ()), standing.motion.frame_rate
    path, seconds = body_point_positions(joint.point, before), np.arange(before.frame_count) / rate
    limb = limb_of(joint.point.part)
    stands = standing.limb_freedoms[limb] == 0.0 if limb >= 0 else np.zeros(len(path), dtype=bool)
    back, on = free_frames(stands, row)
    begin, end = max(row - back, 0) / rate, min(row + on, len(path) - 1) / rate
    freedom = standing.limb_freedoms[limb] if limb >= 0 else None
    limb_path = _limb_path(before, joint.point, row)
    times = fitted_activation(seconds, path, float(seconds[row]), begin, end, limb_path, freedom)
    return _position(joint, path[row], times)


def _limb_path(motion: AdaptedMotion, point: BodyPoint, row: int) -> LimbPath | None:
    """Path of a point of a forearm, hand, shank or foot to its place at a frame."""
    limb, layout = limb_of(point.part), motion.morphology.layout
    if limb < 0:
        return None
    upper = layout.part_of_segment(layout.upper_arm_segment(limb) if limb < 2 else layout.thigh_segment(limb - 2))
    path = body_point_positions(point, motion)
    ends = (body_point_positions(BodyPoint(upper, at_end=far), motion) for far in (False, True))
    return LimbPath(*ends, path, path[row]) if point.part is not upper else None


def far(standing: GroundedMotion, joint: BodyJoint, row: int, way: FloatArray) -> PositionConstraint:
    """Constraint that pulls a joint far ``way`` (3,) from where it is."""
    before, now = solve_constraints(standing, ()), row / standing.motion.frame_rate
    half = 0.5 * HELD
    times = ActivationCurve(now - half - RAMP, now - half, now + half, now + half + RAMP)
    return _position(joint, body_point_positions(joint.point, before)[row] + way, times)


def _position(joint: BodyJoint, position: FloatArray, times: ActivationCurve) -> PositionConstraint:
    target = (float(position[0]), float(position[1]), float(position[2]))
    return PositionConstraint(ADAPTED_MOTION_ID, joint.name, joint.point, joint.chain, 0, times, target=target)


def measure(case: str, standing: GroundedMotion, constraint: PositionConstraint, row: int) -> Result:
    """Depths of the solved motion beyond those of the unconstrained one."""
    before, solved = solve_constraints(standing, ()), solve_constraints(standing, (constraint,), eased=True)
    heights = [point_heights(each, standing.ground) for each in (before, solved)]
    depths = np.minimum(heights[0], 0.0) - heights[1]
    frame, point = np.unravel_index(int(depths.argmax()), depths.shape)
    peaks = [angular_acceleration(each.rotations[:], each.frame_rate).max(axis=0) for each in (before, solved)]
    peak = float((peaks[1] / np.maximum(peaks[0], QUIET_PEAK)).max())
    missed = 1e3 * float(np.nan_to_num(solved.residuals[0, row]))
    return Result(case, 1e3 * float(depths[frame, point]), _point_name(solved, int(point)), int(frame), missed, peak)


def _point_name(motion: AdaptedMotion, point: int) -> str:
    names = {joint.index: joint.name for joint in body_joints(motion.morphology.layout)}
    return names.get(point, f"point {point}" if point < motion.positions.shape[1] else "sole")


def cases(kind: str, count: int) -> Iterable[Result]:
    """``count`` random cases of *press* or *far*."""
    random = np.random.default_rng(41)
    clips = [*BUNDLED, *(CAPTURES if REAL.is_dir() else ())]
    for number in range(count):
        name, body = clips[number % len(clips)], BODIES[number // len(clips) % len(BODIES)]
        standing = standing_on(name, body)
        joints = body_joints(standing.morphology.layout)
        joint, row = joints[random.integers(len(joints))], int(random.integers(standing.motion.frame_count))
        way = random.normal(size=3)
        way *= random.uniform(*FAR) / np.linalg.norm(way)
        constraint = press(standing, joint, row) if kind == "press" else far(standing, joint, row, way)
        yield measure(f"{kind} {number} {name.split('/')[-1]} {body} {joint.name} {row}", standing, constraint, row)


def main(arguments: Sequence[str]) -> int:
    """Measure and print."""
    counts = [int(each) for each in arguments if each.isdigit()] or [60, 40]
    for kind, count in zip(("press", "far"), (counts * 2)[:2], strict=True):
        results = list(cases(kind, count))
        deep = sorted((each for each in results if each.depth > 1e3 * TOLERANCE), key=lambda each: -each.depth)
        for each in results if "--each" in arguments else deep[:12]:
            print(
                f"{each.case}: {each.depth:.1f} mm, {each.part}, frame {each.frame}; missed {each.missed:.1f} mm",
                f"peak {each.peak:.2f}",
            )
        missed, peaks = ([getattr(each, field) for each in results] for field in ("missed", "peak"))
        deepest = max((each.depth for each in results), default=0.0)
        print(
            f"{kind}: {len(deep)} of {count} deeper than 5 mm, {deepest:.0f} mm at most;",
            f"missed {np.mean(missed):.1f} mm on average; peaks",
            " / ".join(f"{each:.2f}" for each in np.percentile(peaks, [50, 90, 100])),
        )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
