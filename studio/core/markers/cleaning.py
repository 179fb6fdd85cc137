"""Cleaning steps, applied to the points of a trial before a body is solved from them, each with a report.

The recorded trial is kept; the steps are a list beside it and are applied again whenever the list changes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.markers.gaps import Gap, find_gaps, pattern_through, spline_through, stiffness
from studio.core.markers.swaps import find_swaps, with_swaps_undone
from studio.core.markers.trial import MARKER_KIND, Trial, seen_mask
from studio.core.names import counted_noun
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]

Fill = Callable[[FloatArray, Gap], FloatArray | None]

_ORDER = 2
_MOST_GAPS = 3000
"""A trial with more of them is noise; the rest stays open."""
_SHOWN = 6
"""Lines of detail in a report; the rest is counted."""


def _positive(number: float, what: str) -> None:
    if not (np.isfinite(number) and number > 0.0):
        raise StudioError(f"{what} must be more than zero, not {number:g}.")


@dataclass(frozen=True)
class StepReport:
    """Report of a cleaning step in sentences, of which ``summary`` comes first."""

    title: str
    summary: str
    details: tuple[str, ...] = ()
    told: bool = True
    """True if the step changed something, or left something undone, so that the user should see the report."""


@dataclass(frozen=True)
class UndoSwaps:
    """Undo swaps of labels between two markers, from the frame in which their tracks cross."""

    kind: Literal["undo_swaps"] = "undo_swaps"
    title: ClassVar[str] = "Fix marker swaps"

    def apply(self, trial: Trial) -> tuple[Trial, StepReport]:
        """Trial in which each pair of swapped labels is exchanged from the frame in which their tracks cross."""
        swaps = find_swaps(trial.points, _places(trial), trial.frame_rate, trial.metres)
        details = [
            f"{trial.labels[swap.first]} and {trial.labels[swap.second]} from frame {swap.frame} on" for swap in swaps
        ]
        if not swaps:
            return trial, StepReport(self.title, "No swapped markers were found.")
        return trial.with_points(with_swaps_undone(trial.points, swaps)), _report(
            self.title, f"{counted_noun(len(swaps), 'swap')} fixed.", details
        )


@dataclass(frozen=True)
class FillShortGaps:
    """Fill short gaps of a marker by a spline."""

    kind: Literal["fill_short_gaps"] = "fill_short_gaps"
    longest: float = 0.15
    """Longest gap in seconds that is filled."""
    title: ClassVar[str] = "Fill short gaps"

    def __post_init__(self) -> None:
        _positive(self.longest, "The longest gap")

    def apply(self, trial: Trial) -> tuple[Trial, StepReport]:
        """Trial in which gaps of up to ``longest`` seconds with frames on both sides are filled."""
        most = int(self.longest * trial.frame_rate + 1e-9)
        gaps = [gap for gap in find_gaps(trial.points, _places(trial)) if gap.frames <= most]
        return _filled(trial, self.title, gaps, spline_through, "with a spline")


@dataclass(frozen=True)
class FillLongGaps:
    """Fill long gaps of a marker by the rigid motion of at least three neighbours on the same bone."""

    kind: Literal["fill_long_gaps"] = "fill_long_gaps"
    title: ClassVar[str] = "Fill long gaps"

    def apply(self, trial: Trial) -> tuple[Trial, StepReport]:
        """Trial in which every gap is filled for which rigidly connected neighbours are seen.

        The shortest gaps come first, because a filled marker may help to fill the next one.
        """
        places = _places(trial)
        gaps = sorted(find_gaps(trial.points, places), key=lambda gap: gap.frames)
        known = stiffness(trial.points, places, trial.metres)
        return _filled(
            trial,
            self.title,
            gaps,
            lambda points, gap: pattern_through(points, gap, known),
            "from neighbouring markers",
        )


@dataclass(frozen=True)
class LowPass:
    """Remove tremble from the points by a Butterworth filter of fourth order without lag."""

    kind: Literal["low_pass"] = "low_pass"
    cutoff: float = 8.0
    """Frequency in Hz at which the amplitude falls to 0.707."""
    title: ClassVar[str] = "Smooth"

    def __post_init__(self) -> None:
        _positive(self.cutoff, "The cut-off frequency")

    def apply(self, trial: Trial) -> tuple[Trial, StepReport]:
        """Trial in which each run of frames without gaps is filtered forwards and backwards.

        The cut-off is corrected for two passes and for the frame rate (Winter 2009): tan(pi f / rate) / (sqrt 2 -
        1)^1/4.
        """
        from scipy.signal import butter, sosfiltfilt  # slow to import, and few trials are smoothed

        rate = trial.frame_rate
        if self.cutoff >= 0.45 * rate:
            return trial, StepReport(
                self.title,
                f"Nothing was smoothed: at {rate:g} frames per second there is no signal above {0.45 * rate:g} Hz.",
            )
        once = np.tan(np.pi * self.cutoff / rate) / (np.sqrt(2.0) - 1.0) ** 0.25
        corrected = rate / np.pi * np.arctan(once)
        sections = butter(_ORDER, corrected, fs=rate, output="sos")
        points = trial.points.copy()
        least = 3 * (2 * _ORDER + 1)
        moved, skipped = 0.0, 0
        for place in _places(trial):
            for first, end in runs_of(seen_mask(points[:, place])):
                if end - first <= least:
                    skipped += 1
                    continue
                smooth = sosfiltfilt(sections, points[first:end, place], axis=0)
                moved = max(moved, float(np.linalg.norm(smooth - points[first:end, place], axis=-1).max()))
                points[first:end, place] = smooth
        summary = f"Smoothed at {self.cutoff:g} Hz; no marker moved more than {1000 * moved * trial.metres:.1f} mm."
        details = (
            (f"{counted_noun(skipped, 'stretch', 'stretches')} of less than {least + 1} frames were not smoothed.",)
            if skipped
            else ()
        )
        return trial.with_points(points), StepReport(self.title, summary, details)


Step = UndoSwaps | FillShortGaps | FillLongGaps | LowPass
CLEANING_STEPS: tuple[type[Step], ...] = (UndoSwaps, FillShortGaps, FillLongGaps, LowPass)
USUAL_STEPS: tuple[Step, ...] = (FillShortGaps(), FillLongGaps())
"""Cleaning steps that are applied by default: gaps are filled, and seen positions are kept."""


def cleaned_trial(trial: Trial, steps: Sequence[Step]) -> tuple[Trial, tuple[StepReport, ...]]:
    """Trial after all ``steps``, in order, and the report of each; ``trial`` itself is unchanged."""
    reports = []
    for step in steps:
        trial, report = step.apply(trial)
        reports.append(report)
    return trial, tuple(reports)


def _filled(trial: Trial, title: str, gaps: list[Gap], fill: Fill, how: str) -> tuple[Trial, StepReport]:
    points = trial.points.copy()
    done, details = [], []
    for gap in gaps[:_MOST_GAPS]:
        path = fill(points, gap)
        if path is not None:
            points[gap.first : gap.last + 1, gap.place] = path
            done.append(gap)
            details.append(f"{trial.labels[gap.place]} frames {gap.first} to {gap.last}")
    left = len(gaps) - len(done)
    open_words = f" {counted_noun(left, 'gap')} left open." if left else ""
    if not done:
        return trial, StepReport(title, f"Nothing filled.{open_words}", told=bool(left))
    frames = sum(gap.frames for gap in done)
    summary = f"{counted_noun(len(done), 'gap')} filled {how}, {counted_noun(frames, 'frame')} in all.{open_words}"
    return trial.with_points(points), _report(title, summary, details)


def _report(title: str, summary: str, details: list[str]) -> StepReport:
    shown = details[:_SHOWN]
    more = [f"and {len(details) - _SHOWN} more"] if len(details) > _SHOWN else []
    return StepReport(title, summary, tuple(shown + more))


def _places(trial: Trial) -> tuple[int, ...]:
    return tuple(index for index, kind in enumerate(trial.kinds) if kind == MARKER_KIND)
