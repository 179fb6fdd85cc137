"""Error strip of a constraint on one performer: the state of each frame, from held to not reached."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.core.stage.timing import Timing
from studio.engine.residual_measures import LENGTH_MEASURE, Measure, measure_of
from studio.engine.residuals import residuals_on


class StripState(StrEnum):
    """State of an error strip in a frame, with its label."""

    INACTIVE = "not active"
    YIELDING = "overridden by contact"
    HELD = "met"
    PARTLY = "partly met"
    NOT_REACHED = "not met"
    UNKNOWN = "not solved yet"


@dataclass(frozen=True, eq=False)
class ErrorStrip:
    """Residuals (F,), in metres or radians, and activation (F,) of a constraint in the frames of a performer's
    track.

    A residual is NaN where the constraint is inactive; if the activation is positive there, the constraint of a foot is
    overridden by that foot's contact.
    """

    timing: Timing
    """Stage times of the frames."""
    errors: NDArray[np.float64]
    activation: NDArray[np.float64]
    measure: Measure = LENGTH_MEASURE

    def frames_at(self, seconds: ArrayLike) -> NDArray[np.int64]:
        """Indices of the frames at stage times in seconds, also before the first and after the last one."""
        since = np.asarray(seconds, dtype=np.float64) - self.timing.begin
        return np.rint(since * self.timing.frame_rate).astype(np.int64)

    def error_at(self, seconds: float) -> float:
        """Residual at a stage time in seconds; NaN outside of the track."""
        frame = int(self.frames_at(seconds))
        return float(self.errors[frame]) if 0 <= frame < len(self.errors) else float("nan")

    def state_at(self, seconds: float) -> StripState:
        """State at a stage time in seconds."""
        frame = int(self.frames_at(seconds))
        if not 0 <= frame < len(self.errors):
            return StripState.INACTIVE
        return STRIP_STATES[int(self.state_indices[frame])]

    @property
    def span(self) -> tuple[float, float] | None:
        """Stage times in seconds of the first and last frame in which the constraint is active; None if it never is."""
        active = np.flatnonzero(self.state_indices)
        if not len(active):
            return None
        return self.timing.stage_time(int(active[0])), self.timing.stage_time(int(active[-1]))

    @cached_property
    def state_indices(self) -> NDArray[np.int64]:
        """(F,) index in ``STRIP_STATES`` of the state of each frame."""
        return np.select(
            [
                self.activation <= 0.0,
                ~np.isfinite(self.errors),
                self.errors < self.measure.held_below,
                self.errors < self.measure.partly_below,
            ],
            range(4),
            default=4,
        )

    @property
    def misses(self) -> bool:
        """True if the target is not reached in any frame, fades included."""
        return bool((self.state_indices >= STRIP_STATES.index(StripState.PARTLY)).any())

    @property
    def yields(self) -> bool:
        """True if the constraint is overridden by a contact in any frame."""
        return bool((self.state_indices == 1).any())


STRIP_STATES = tuple(StripState)


def strip_of(
    project: Project, performer_id: str, result: AdaptedMotion | None, constraint_id: str
) -> ErrorStrip | None:
    """Error strip of a constraint in a performer's newest result; None if there is no result or the constraint does not
    apply.
    """
    missed = residuals_on(project, performer_id, result, constraint_id)
    if missed is None:
        return None
    # A clip that is cut within a fade does without the constraint, and frames that are not played do.
    activation = np.where(np.isfinite(missed.amounts) | (missed.freedom < 1.0), missed.activation, 0.0)
    return ErrorStrip(missed.timing, missed.amounts, activation, measure_of(project.constraints[constraint_id]))


def strip_heights(errors: NDArray[np.float64], most: int, measure: Measure = LENGTH_MEASURE) -> NDArray[np.int64]:
    """Heights in pixels for residuals: 1 if held, growing with the logarithm to ``most``."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.log(errors / measure.held_below) / np.log(measure.worst_shown / measure.held_below)
    heights: NDArray[np.int64] = 1 + np.rint(np.clip(np.nan_to_num(share), 0.0, 1.0) * (most - 1)).astype(np.int64)
    return heights
