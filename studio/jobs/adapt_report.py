"""Report on a motion adapted to one character: quality metrics and residuals of constraints."""

import math
import time
from collections import Counter
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.base import Constraint
from studio.core.quality.metrics import MotionPeaks, worst_of
from studio.core.quality.motion_measures import ADDED_MEASURES
from studio.core.quality.report import (
    BLOCKED_BY_CLEARANCE,
    BLOCKED_BY_CONTACTS,
    BLOCKED_BY_CORRECTIONS,
    BLOCKED_BY_FOLLOWED,
    BLOCKED_BY_GROUND,
    BLOCKED_BY_LIMITS,
    BLOCKED_BY_NOTHING,
    BLOCKED_BY_REACH,
    BLOCKED_BY_SMOOTHING,
    BLOCKED_BY_TOLERANCE,
    BLOCKED_BY_TOUCHES,
    MET_TOLERANCE_BY_UNIT,
    QualityReport,
    fully_active,
    report_of,
)
from studio.core.solver.adapt import grounded_motion, solve_request
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.warm_up import warm_up
from studio.core.stage.placement import Placement
from studio.io.json_text import JsonObject

FloatArray = NDArray[np.float64]

MET_MILLIMETRES, MET_DEGREES = 1000.0 * MET_TOLERANCE_BY_UNIT["m"], math.degrees(MET_TOLERANCE_BY_UNIT["rad"])
"""Greatest residual with which a target counts as met, in millimetres and in degrees."""
BLOCKER_NAMES = {
    BLOCKED_BY_NOTHING: None,
    BLOCKED_BY_CONTACTS: "contacts",
    BLOCKED_BY_LIMITS: "joint limits",
    BLOCKED_BY_REACH: "reach",
    BLOCKED_BY_SMOOTHING: "smoothing",
    BLOCKED_BY_TOUCHES: "touches",
    BLOCKED_BY_CLEARANCE: "clearance",
    BLOCKED_BY_TOLERANCE: "tolerance",
    BLOCKED_BY_CORRECTIONS: "corrections",
    BLOCKED_BY_FOLLOWED: "followed character",
    BLOCKED_BY_GROUND: "ground",
}
"""Names in reports of the blockers of a constraint other than another constraint, by code; None for no blocker."""


def character_report(
    request: AdaptRequest, source: MotionPeaks, first_frame: int, *, by_frame: bool = False
) -> tuple[AdaptedMotion, JsonObject]:
    """Adapted motion from ``first_frame`` on, and the record of its quality."""
    load_kernels(request.morphology.first_frame_body)
    start = time.perf_counter()
    standing = grounded_motion(request)
    adapted = solve_request(standing, request, first_frame)
    seconds = time.perf_counter() - start
    record = quality_record(standing, request, adapted, source, by_frame)
    return adapted, {**record, "microseconds_per_frame": 1e6 * seconds / adapted.frame_count}


def place_record(placement: Placement) -> JsonObject:
    """Record of a character's placement on the stage: metres along X and Y, degrees about Z."""
    return {"position": list(placement.position), "heading_deg": math.degrees(placement.heading)}


def quality_record(
    standing: GroundedMotion, request: AdaptRequest, adapted: AdaptedMotion, source: MotionPeaks, by_frame: bool
) -> JsonObject:
    """Record of the quality of an adapted motion and of its constraints.

    Some measures are relative to the same frames of its ``source``.
    """
    report, peaks = report_of(standing, request, adapted), MotionPeaks.of(adapted)
    quality = worst_of(report.slides, report.heights)
    record: JsonObject = {
        "slide_mm": 1000.0 * quality.slide,
        "float_mm": 1000.0 * max(quality.rise, 0.0),
        "penetration_mm": 1000.0 * max(quality.penetration, -float(report.lowest.min()), 0.0),
        "skate_mm": 1000.0 * float(report.skates.max()),
        "acceleration_ratio": peaks.acceleration_ratio(source),
        "speed_ratio": peaks.speed_ratio(source),
        "knee_speed_deg": math.degrees(float(report.knee_speeds.max())),
        "knee_speed_ratio": peaks.knee_speed_ratio(source),
        "mass_margin_mm": _least(1000.0 * report.mass_margins),
        "constraints": constraint_records(request, adapted, report, by_frame),
    }
    if ADDED_MEASURES:
        record["measures"] = measure_records(adapted, by_frame)
    if by_frame:
        record["by_frame"] = frame_records(report)
    return record


def measure_records(adapted: AdaptedMotion, by_frame: bool) -> JsonObject:
    """Record of each plug-in's measure by title: unit, mean and greatest value, or the error of one that failed."""
    record: JsonObject = {}
    for title, measure in ADDED_MEASURES.items():
        try:
            values = measure.of(adapted)
        except ValueError as error:
            record[title] = {"unit": measure.unit, "error": str(error)}
            continue
        known = values[np.isfinite(values)]
        record[title] = {
            "unit": measure.unit,
            "mean": float(known.mean()) if len(known) else None,
            "greatest": float(known.max()) if len(known) else None,
            **({"by_frame": _numbers(values)} if by_frame else {}),
        }
    return record


@lru_cache(maxsize=16)
def load_kernels(body: Morphology) -> None:
    """Load the kernels, so that the time to load them is not measured."""
    warm_up(body)


def frame_records(report: QualityReport) -> JsonObject:
    """Measures of feet, knees and balance, one number per frame from the first adapted one; null where
    there is none.
    """
    slides, depths = 1000.0 * report.slides, 1000.0 * np.maximum(-report.heights, 0.0)
    return {
        "slide_mm": {point.value: _numbers(row) for point, row in zip(ContactPoint, slides, strict=True)},
        "penetration_mm": {point.value: _numbers(row) for point, row in zip(ContactPoint, depths, strict=True)},
        "lowest_mm": _numbers(1000.0 * report.lowest),
        "skate_mm": {side: _numbers(1000.0 * row) for side, row in zip(("left", "right"), report.skates, strict=True)},
        "knee_speed_deg": {
            side: _numbers(np.degrees(row)) for side, row in zip(("left", "right"), report.knee_speeds, strict=True)
        },
        "mass_margin_mm": _numbers(1000.0 * report.mass_margins),
    }


def constraint_records(
    request: AdaptRequest, adapted: AdaptedMotion, report: QualityReport, by_frame: bool
) -> list[JsonObject]:
    """Record of each constraint: in how many frames it is fully active, and met, its worst residual, and its blockers.

    For the frames in which it is fully active and not met, the number blocked by each cause is given; contacts on its
    limb count as a cause as well. With ``by_frame`` the residual and the cause of every frame are added, null if there
    is none.
    """
    records = []
    frames = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    for row, asked in enumerate(fully_active(request.constraints, request.motion.times[frames])):
        constraint = request.constraints[row]
        factor = math.degrees(1.0) if constraint.unit == "rad" else 1000.0
        misses, kept_by = report.misses[row], [_winner(int(code), request.constraints) for code in report.winners[row]]
        missed = asked & ~(misses <= MET_TOLERANCE_BY_UNIT[constraint.unit])
        worst = np.nanmax(misses[asked], initial=-math.inf)
        record: JsonObject = {"name": constraint.name, "kind": constraint.kind}
        record |= residual_record(constraint, float(worst) if math.isfinite(worst) else None)
        record |= {"frames_asked": int(asked.sum()), "frames_held": int(asked.sum() - missed.sum())}
        if asked.any():
            record["reached"] = not missed.any()
        record["kept_by"] = dict(Counter(kept_by[frame] for frame in np.flatnonzero(missed)).most_common())
        if by_frame:
            told = np.where(asked, misses, adapted.residuals[row])
            record["by_frame"] = {"residual": _numbers(factor * told), "kept_by": kept_by}
        records.append(record)
    return records


def _winner(code: int, constraints: Sequence[Constraint]) -> str | None:
    return constraints[code].name if code >= 0 else BLOCKER_NAMES[code]


def _numbers(values: FloatArray) -> list[float | None]:
    """Values rounded to a thousandth; None where one is not finite, as JSON has no number for that."""
    return [round(value, 3) if math.isfinite(value) else None for value in values.tolist()]


def _least(values: FloatArray) -> float | None:
    known = values[np.isfinite(values)]
    return float(known.min()) if len(known) else None


def residual_record(constraint: Constraint, residual: float | None) -> JsonObject:
    """Record of a residual, given in metres or radians, in the unit of the report; None if there is none."""
    is_angle = constraint.unit == "rad"
    shown = None if residual is None else math.degrees(residual) if is_angle else 1000.0 * residual
    return {
        "residual_mm": None if is_angle else shown,
        "residual_deg": shown if is_angle else None,
        "reached": None if shown is None else shown <= (MET_DEGREES if is_angle else MET_MILLIMETRES),
    }
