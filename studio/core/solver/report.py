"""What became of every constraint in every frame, and of the feet, the knees and the balance: arrays for plots.

Who kept a constraint from being met is found by asking what would be without: each other constraint of its priority or
a higher one, the contacts of the feet, the limits of the joints, easing in time. The one without which most of the miss
would be gone is named; where nobody's absence helps, the body reaches no further.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.kernels.tasks.task import STRICT
from studio.core.quality.contact_tracks import contact_tracks
from studio.core.quality.metrics import centre_of_mass, knee_speeds
from studio.core.solver.asking.measured import misses
from studio.core.solver.asking.tracks import Tracks
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.solved_window import Bound, SolvedWindow, constraint_activations, targets_of
from studio.core.solver.standing.stand import Standing
from studio.core.solver.standing.support import outlines, standing_points, support_margins

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]

NOBODY, CONTACTS, LIMITS, REACH, EASED = -1, -2, -3, -4, -5
"""Who kept a constraint from being met, beside the row of another one: nobody (it is met, or not asked), the feet that
stand, how far joints turn, the measures of the body and the chain that may move, a moment that was eased in time."""
MET = {"m": STRICT, "rad": float(np.radians(0.1))}
"""What counts as met, by unit."""
WORTH = 0.05
"""Part of a miss that an absence has to take away to have mattered."""


@dataclass(frozen=True, eq=False)
class Report:
    """Of C constraints over F frames.

    ``residuals`` (C, F) metres or radians, NaN where not active; ``misses`` (C, F) the same measured on the poses, at
    full activation, whether they act or not (``measured.misses``); ``winners`` (C, F) who kept each from being met: the
    row of a constraint, or one of the names above; ``slides`` and ``heights`` (9, F) metres, a row a ``ContactPoint``,
    NaN where a point does not stand; ``knee_speeds`` (2, F) rad/s; ``mass_margins`` (F,) metres from the centre of
    mass to the edge of what is stood on, negative outside, NaN in flight.
    """

    residuals: FloatArray
    misses: FloatArray
    winners: IntArray
    slides: FloatArray
    heights: FloatArray
    knee_speeds: FloatArray
    mass_margins: FloatArray


def report_of(standing: Standing, request: AdaptRequest, adapted: AdaptedMotion) -> Report:
    """All there is to say of ``adapted``, the answer to ``request``, which stands so, in any window."""
    window = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    stands = standing_points(standing.contacts, request.motion.frame_count)[:, window]
    areas = outlines(adapted.positions[:], adapted.rotations[:], stands, adapted.morphology)
    slides, heights = contact_tracks(adapted, standing.contacts, request.ground)
    return Report(
        adapted.residuals,
        misses(request.constraints, targets_of(standing, request.constraints, window, request.tracks), adapted),
        winners(standing, request.constraints, request.tracks, adapted, request.eased),
        slides,
        heights,
        knee_speeds(adapted),
        support_margins(areas, centre_of_mass(adapted)[:, :2]),
    )


def winners(
    standing: Standing, constraints: Sequence[Constraint], tracks: Tracks, adapted: AdaptedMotion, eased: bool = False
) -> IntArray:
    """(C, F) who kept each constraint from being met; see ``Report``."""
    residuals, first = adapted.residuals, adapted.first_frame
    if not constraints:
        return np.empty(residuals.shape, dtype=np.int64)
    limits = np.array([[MET[each.unit]] for each in constraints]).reshape(-1, 1)
    missed = residuals > limits
    found = np.where(missed, REACH, NOBODY)
    best = np.maximum(limits, WORTH * np.nan_to_num(residuals))

    def weigh(name: int, rows: list[int], asked: Sequence[Constraint], bound: Bound, acts: Mask | None = None) -> None:
        """Solve for ``asked`` alone, the constraints of ``rows``, where any of them is missed and what is left out
        ``acts`` (F,), and note where that is better than any so far.
        """
        frames = np.flatnonzero(missed[rows].any(axis=0) & (True if acts is None else acts))
        if len(frames):
            here = np.ix_(np.array(rows), frames)
            gain = residuals[here] - residuals_at(standing, asked, first + frames, tracks, bound)
            better = missed[here] & (gain > best[here])
            found[here] = np.where(better, name, found[here])
            best[here] = np.where(better, gain, best[here])

    if missed.any():
        everybody = list(range(len(constraints)))
        if eased:
            weigh(EASED, everybody, constraints, Bound())
        weigh(CONTACTS, everybody, constraints, Bound(by_contacts=False))
        weigh(LIMITS, everybody, constraints, Bound(by_limits=False))
        ranks = np.array([each.priority for each in constraints])
        for row in everybody:
            others = [other for other in everybody if other != row]
            if missed[others][ranks[others] >= ranks[row]].any():
                without = [constraints[other] for other in others]
                weigh(row, others, without, Bound(), np.isfinite(residuals[row]))
        for row in np.flatnonzero((found == REACH).any(axis=1)).tolist():
            _weigh_together(row, standing, constraints, tracks, adapted, found, best)
    found[_yielding(standing, constraints, slice(first, first + adapted.frame_count))] = CONTACTS
    return found


def residuals_at(
    standing: Standing, constraints: Sequence[Constraint], frames: IntArray, tracks: Tracks, bound: Bound
) -> FloatArray:
    """(C, n) what each is missed by at some ``frames`` (n,), in order, of the whole motion, each solved by itself."""
    window = slice(int(frames[0]), int(frames[-1]) + 1)
    activations = constraint_activations(constraints, standing)
    solved = SolvedWindow(standing, constraints, activations, tracks, bound, window)
    solved.solve(frames - window.start)
    return solved.residuals[:, frames - window.start]


def _weigh_together(
    row: int,
    standing: Standing,
    constraints: Sequence[Constraint],
    tracks: Tracks,
    adapted: AdaptedMotion,
    found: IntArray,
    best: FloatArray,
) -> None:
    """Where several stand in the way, and none of them alone, the first of them is named."""
    own, helped = constraints[row], found[row] == REACH
    frames = np.flatnonzero(helped)
    alone = residuals_at(standing, [own], adapted.first_frame + frames, tracks, Bound())[0]
    helped[frames] = adapted.residuals[row, frames] - alone > best[row, frames]
    above = [k for k, each in enumerate(constraints) if k != row and each.priority <= own.priority]
    for other in sorted(above, key=lambda k: constraints[k].priority):
        here = helped & np.isfinite(adapted.residuals[other])
        found[row, here] = other
        helped &= ~here


def _yielding(standing: Standing, constraints: Sequence[Constraint], window: slice) -> NDArray[np.bool_]:
    """(C, F) where a constraint on a limb gives way to the contacts of that limb."""
    rate = standing.motion.frame_rate
    times = np.arange(standing.motion.frame_count)[window] / rate
    wanted = np.array([each.activation.at(times) for each in constraints])
    given = constraint_activations(constraints, standing)[:, window]
    return np.asarray(given < wanted - 1e-9)
