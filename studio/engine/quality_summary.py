"""Summary of residuals and defects of every performer, and the problems in it, worst first.

A row is a constraint on a performer, measured while the constraint is active, or a performer's whole motion.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.carried_over import mirrored_constraint
from studio.core.solver.performers.rows import timing_of
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.engine.posed_performer import stage_time
from studio.engine.residual_measures import LENGTH_MEASURE, PEAK_MEASURE, SKATE_MEASURE, Measure
from studio.engine.residuals import worst_residual

FloatArray = NDArray[np.float64]

WHOLE_MOTION = "Whole motion"
ASPECTS = ("residual", "slide", "skate", "penetration", "peak")
ASPECT_TITLES = {
    "residual": "Error",
    "slide": "Contact sliding",
    "skate": "Foot sliding",
    "penetration": "Penetration",
    "peak": "Pop",
}
ASPECT_HINTS = {
    "residual": "Worst error while fully active",
    "slide": "Farthest that a standing heel, toe, hand, knee or seat has moved since its contact began",
    "skate": "Farthest that a foot goes along the ground, standing or not, while it is near it and slower than a swing",
    "penetration": "Deepest that a standing point or the sole of a foot is below the ground",
    "peak": "Highest angular acceleration of a limb, beside the highest of the same limb in the capture",
}


@dataclass(frozen=True)
class Finding:
    """Worst ``amount`` of one aspect (metres, radians or a ratio, by its ``measure``), and its stage time in
    seconds.
    """

    amount: float
    time: float
    measure: Measure = LENGTH_MEASURE

    @property
    def text(self) -> str:
        """Amount as text with unit."""
        return self.measure.text_of(self.amount)

    @property
    def weight(self) -> float:
        """Badness of the amount, comparable between measures."""
        return self.measure.weight(self.amount)


@dataclass(frozen=True)
class SummaryRow:
    """Findings by aspect of a constraint on a performer, or of a performer's whole motion."""

    performer_id: str
    body: str
    constraint_id: str | None
    name: str
    findings: Mapping[str, Finding]


@dataclass(frozen=True)
class FoundProblem:
    """Finding that is large enough to be reported."""

    row: SummaryRow
    aspect: str
    finding: Finding

    @property
    def key(self) -> tuple[str, str | None, str]:
        """Performer id, constraint id and aspect, which identify the problem while its amount changes."""
        return self.row.performer_id, self.row.constraint_id, self.aspect

    @property
    def sentence(self) -> str:
        """Problem as text: ``Tall man: error 42 mm, Right wrist``."""
        return f"{self.row.body}: {ASPECT_TITLES[self.aspect].lower()} {self.finding.text}, {self.row.name}"


def summary_of(
    project: Project, motions: Mapping[str, AdaptedMotion], sources: Mapping[str, AdaptedMotion]
) -> tuple[SummaryRow, ...]:
    """Rows for each visible performer with a result and for each constraint on it; ``sources`` are source motions by
    motion id.
    """
    return tuple(
        row
        for key, performer in project.performers.items()
        if performer.visible and performer.clips and key in motions
        for row in _rows_of(project, key, motions[key], sources)
    )


def problems_in(rows: tuple[SummaryRow, ...]) -> tuple[FoundProblem, ...]:
    """Problems, worst first: residuals of constraints, and the other aspects of whole motions."""
    found = [
        FoundProblem(row, aspect, finding)
        for row in rows
        for aspect, finding in row.findings.items()
        if (aspect == "residual") != (row.constraint_id is None) and finding.amount > finding.measure.worth_saying
    ]
    return tuple(sorted(found, key=lambda each: -each.finding.weight))


def _rows_of(
    project: Project, performer_id: str, motion: AdaptedMotion, sources: Mapping[str, AdaptedMotion]
) -> Iterator[SummaryRow]:
    performer = project.performers[performer_id]
    timing = timing_of(project, performer)
    times = timing.begin + (motion.first_frame + np.arange(motion.frame_count)) / timing.frame_rate
    tracks = _tracks(project, performer_id, motion, sources)
    everywhere = {aspect: _worst(values, times, measure) for aspect, (values, measure) in tracks.items()}
    yield SummaryRow(performer_id, performer.name, None, WHOLE_MOTION, _known(everywhere))
    listed: set[str] = set()
    for asked in constraints_of_performer(project, performer_id):
        if asked.constraint_id in listed:
            continue
        listed.add(asked.constraint_id)
        constraint, clip = asked.constraint, performer.clips[asked.clip]
        rate, curve = project.frame_rate_of(clip), constraint.activation
        begin, end = (stage_time(clip, rate, second) for second in (curve.start, curve.end))
        acts = (times >= begin) & (times <= end)
        own = {aspect: _worst(np.where(acts, values, np.nan), times, each) for aspect, (values, each) in tracks.items()}
        found = worst_residual(project, performer_id, motion, asked.constraint_id)
        if found is not None:
            own["residual"] = Finding(found.amount, found.time, found.measure)
        name = (mirrored_constraint(constraint) if clip.mirrored else constraint).name
        yield SummaryRow(performer_id, performer.name, asked.constraint_id, name, _known(own))


def _known(findings: Mapping[str, Finding | None]) -> Mapping[str, Finding]:
    return {aspect: findings[aspect] for aspect in ASPECTS if findings.get(aspect) is not None}  # type: ignore[misc]


def _worst(values: FloatArray, times: FloatArray, measure: Measure) -> Finding | None:
    if not np.isfinite(values).any():
        return None
    index = int(np.nanargmax(values))
    return Finding(float(values[index]), float(times[index]), measure)


def _tracks(
    project: Project, performer_id: str, motion: AdaptedMotion, sources: Mapping[str, AdaptedMotion]
) -> dict[str, tuple[FloatArray, Measure]]:
    """(F,) values and measure of each aspect except residuals; NaN where unknown."""
    from studio.core.quality.contact_tracks import contact_tracks  # not before a result is there: they load kernels
    from studio.core.quality.metrics import skate_distances, swing_depths

    performer = project.performers[performer_id]
    ground = project.ground.seen_from(performer.position, performer.heading)
    composite = motion.composite
    contacts = motion.contacts if composite else tuple(project.contacts_of(performer.clips[0].motion_id).values())
    slides, heights = contact_tracks(motion, contacts, ground)
    depths = np.concatenate([-heights, swing_depths(motion, contacts, ground)])
    tracks = {
        "slide": (np.fmax.reduce(slides, axis=0), LENGTH_MEASURE),
        "skate": (skate_distances(motion, ground).max(axis=0), SKATE_MEASURE),
        "penetration": (np.maximum(np.fmax.reduce(depths, axis=0), 0.0), LENGTH_MEASURE),
    }
    source = sources.get(performer.clips[0].motion_id)
    if source is not None and (composite is None or composite.is_plain):
        tracks["peak"] = (_peaks(motion, source), PEAK_MEASURE)
    return tracks


def _peaks(motion: AdaptedMotion, source: AdaptedMotion) -> FloatArray:
    """(F,) largest angular acceleration of a limb segment, relative to its peak in the source."""
    from studio.core.normalized.transition import QUIET_PEAK
    from studio.core.quality.metrics import LIMB_BONES, angular_acceleration, turning_peaks

    peaks = np.full(motion.frame_count, np.nan)
    if motion.frame_count < 3:
        return peaks
    parts = tuple(BodyPart)
    segments = [motion.morphology.layout.segment_of_part(parts[place]) for place in LIMB_BONES]
    turning = angular_acceleration(np.asarray(motion.rotations[:, segments]), motion.frame_rate)
    first = motion.first_frame
    theirs = turning_peaks(source.frames(first, first + motion.frame_count - 1))[LIMB_BONES, 1]
    peaks[1:-1] = (turning / np.maximum(theirs, QUIET_PEAK)).max(axis=1)
    return peaks
