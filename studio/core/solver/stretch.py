"""A stretch of a standing motion with its constraints: packed for the kernels, solved, and eased where that jolts."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.balance import Support
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow, FollowBody
from studio.core.constraints.target import follows_of
from studio.core.contacts import ContactInterval
from studio.core.errors import StudioError
from studio.core.joint_limits import limits_of
from studio.core.kernels.adapt import solve_frames
from studio.core.metrics import QUIET
from studio.core.morphology import at_frames
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.carrying import limb_freedom
from studio.core.solver.chains import carrying_chain, free_joints, segment_masses
from studio.core.solver.clearance import lowest_first, pack_clearance
from studio.core.solver.easing import WIDTHS, Easing, EasingArrays, Level, Solve, reach_of
from studio.core.solver.footing import Footing, leashes
from studio.core.solver.holding import held_points, place_above, release_hands
from studio.core.solver.packing import in_order, limb_of, pack, share_by_weight
from studio.core.solver.recruiting import find_recruits, leg_room, limb_freedoms
from studio.core.solver.root_leash import RootLeash
from studio.core.solver.support import mass_path, standing_points, support_path
from studio.core.solver.tracks import Targets, Track, Tracks
from studio.core.solver.wished import brought

if TYPE_CHECKING:
    from studio.core.solver.adapt import Bound, Standing

FloatArray = NDArray[np.float64]


class Stretch:
    """Constraints on the frames of ``window``; nothing else depends on how wide that is."""

    def __init__(
        self, standing: "Standing", constraints: Sequence[Constraint], window: slice, tracks: Tracks, bound: "Bound"
    ) -> None:
        """``tracks`` over the whole motion; StudioError where something is followed that they do not have."""
        motion, body = standing.motion, standing.morphology
        self.standing, self.window, self._asked = standing, window, (constraints, tracks, bound)
        self._positions, self._rotations = standing.positions[window].copy(), standing.rotations[window].copy()
        held = (
            held_points(standing.holds, standing.footing, body, standing.positions, standing.rotations)
            if bound.by_contacts
            else []
        )
        self._clear = lowest_first(constraints)
        self._order = [c for c in in_order(constraints) if c not in self._clear]
        everything = [*(each.constraint for each in held), *(constraints[c] for c in self._order)]
        everywhere = constraint_activations(constraints, standing.contacts, motion)
        given = everywhere[:, window]
        activations, self._held = given[self._order], len(held)
        known = _known_tracks(standing, constraints, window, tracks)
        times = np.arange(motion.frame_count)[window] / motion.frame_rate

        def masses() -> FloatArray:  # a method would keep all arrays until somebody looks for rings
            return mass_path(standing.positions[window], body.still)

        self._rows = pack(everything, body.layout, Targets(times, known, masses))
        if held:
            place_above(self._rows, held, window)
            stands = np.array([each.standing[window] for each in held])
            activations = np.concatenate([stands & (given > 0.0).any(axis=0), activations])
        share_by_weight(self._rows)
        ranks, ends = self._rows.asked["rank"], self._rows.asked["ends"][:, :, 2]
        self._levels = int(ranks.max(initial=-1)) + 1
        joints = free_joints(tuple(map(carrying_chain, everything)), tuple(ranks.tolist()), body.layout)
        joints = joints if bound.by_limits else joints.without_limits
        recruits = find_recruits(
            joints, body.layout.spine_count,
            lambda: _freedoms(standing, window, ends[len(held) :], ranks[len(held) :], everywhere[self._order], bound),
        )  # fmt: skip
        self._clearance = pack_clearance(
            [constraints[c] for c in self._clear], everything, len(held), given[self._clear],
            motion, window, standing.actor, standing.volume, body.still,
        )  # fmt: skip
        self._activations = np.ascontiguousarray(activations, dtype=np.float64)
        self._unsolved = standing.positions[window], standing.rotations[window]
        if self._clear:
            self._unsolved = self._positions.copy(), self._rotations.copy()
        leash = np.full((2, len(times)), np.inf)
        if bound.by_contacts:
            leash = np.ascontiguousarray(leashes(standing.footing)[:, window])
        self._limits = limits_of(body.still)[: 4 * (bound.by_limits and standing.limited)]
        self._joints = joints.joints
        legs = legs_of(standing.footing, window)
        measures = at_frames(body.rows, window)
        self._stance = measures, body.layout, legs[1], leash
        self._given = (
            (self._rows.asked, self._rows.areas, joints.arrays, recruits, self._rows.wishes),
            (
                leash, (motion.channels[window], *legs),
                (measures, segment_masses(body.layout), self._limits),
                self._clearance, *self._unsolved,
            ),
        )  # fmt: skip
        self._misses = np.full((len(everything), len(times)), np.nan)

    def solve(self) -> bool:
        """Solve every frame from its own pose; whether anything jolts."""
        self.whole = self._solve_of(self._levels - 1)
        self._pose(self._levels - 1, self.whole.noting)
        return self.whole.jolts

    def _solve_anew(self, level: int, easing: EasingArrays) -> None:
        """Solve with the constraints down to ``level``, from the unsolved poses."""
        before = self.standing.positions[self.window], self.standing.rotations[self.window]
        self._positions[:], self._rotations[:] = before
        if self._clear:
            self._unsolved[0][:], self._unsolved[1][:] = before
        self._pose(level, easing)

    def _pose(self, level: int, easing: EasingArrays) -> None:
        acts, (asked, areas, (mobilities, *joints), (turned, usual, free), wishes) = self._activations, self._given[0]
        if level < self._levels - 1:
            acts = np.where(asked["rank"][:, None] <= level, acts, 0.0)
        rows = len(asked) + level + 1  # what only levels below may move stays where it is
        recruits = turned, np.concatenate([usual[:rows], usual[-1:]]), free
        given = asked, areas, (mobilities[:rows], *joints), recruits, wishes, acts, *self._given[1]
        solve_frames(*given, easing, self._misses, self._positions, self._rotations)

    def _solve_of(self, level: int) -> Solve:
        """To note what is solved down to ``level``."""
        ends = self._rows.asked["ends"][:, :, 2]
        if level < self._levels - 1:
            ends = ends[self._rows.asked["rank"] <= level]
        motion, layout = self.standing.motion, self.standing.morphology.layout
        return Solve.of(layout, motion.frame_rate, len(self._positions), self._joints, ends, int(self._held > 0))

    @property
    def reach(self) -> float:
        """Seconds on either side of a frame that may have to do with how it is eased."""
        return reach_of(self._levels)

    def ease(self, window: slice) -> None:
        """Ease what jolts in ``window``: each run of frames that have to do with each other by itself."""
        room, first = self._room, self.window.start
        edges = np.flatnonzero(np.diff(room > 0.0, prepend=False, append=False))
        beyond = round(max(WIDTHS) * self.standing.motion.frame_rate)
        for begin, end in edges.reshape(-1, 2).tolist():
            if begin < window.stop - first and end > window.start - first:
                wide = slice(max(begin - beyond, 0), min(end + beyond, len(room)))
                frames = slice(first + wide.start, first + wide.stop)
                if frames == self.window:
                    self._ease(room)
                    return
                run = Stretch(self.standing, self._asked[0], frames, *self._asked[1:])
                run.whole = run._solve_of(self._levels - 1)
                for mine, theirs in zip(self._solved, run._solved, strict=True):
                    theirs[:] = mine[wide]
                run._ease(room[wide])
                for mine, theirs in zip(self._solved, run._solved, strict=True):
                    mine[begin:end] = theirs[begin - wide.start : end - wide.start]

    def eases(self, window: slice) -> bool:
        """Whether anything in ``window`` is to be eased."""
        return bool(self._room[window.start - self.window.start : window.stop - self.window.start].any())

    @cached_property
    def _room(self) -> FloatArray:
        return self._level(self._levels - 1).room

    @cached_property
    def _brings(self) -> FloatArray:
        return brought(
            self._rows, self._held, self._activations, *self._unsolved, self.standing.morphology.still,
            self.standing.motion.frame_rate,
        )  # fmt: skip

    def _level(self, number: int) -> Level:
        solve = self._solve_of(number) if number < self._levels - 1 else self.whole
        peak, above = max(QUIET, self.standing.peaks[: len(solve.carriers)].max()), self._rows.asked["rank"] <= number
        acts = np.asarray((self._activations[above] > 0.0).any(axis=0))
        brings = self._brings[0, above].sum(axis=0) + self._brings[1, above].max(axis=0, initial=0.0)
        return Level(solve, acts, peak + brings)

    def _ease(self, room: FloatArray) -> None:
        motion = *self._unsolved, self._positions, self._rotations
        leash = RootLeash.of(self.standing.positions[self.window], *self._stance)
        levels = [self._level(number) for number in range(self._levels)]
        Easing(levels, self._solve_anew, self._pose, motion, self._misses, self._limits, leash, room).ease()

    @property
    def _solved(self) -> tuple[FloatArray, ...]:
        """All that a solve writes, frames first."""
        cleared = (*self._unsolved, self._clearance[7].T) if self._clear else ()
        return self._positions, self._rotations, self._misses.T, self.whole.states, *cleared

    def answer(self, window: slice) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, rotations and residuals of some of its frames."""
        standing = self.standing
        if standing.arms is not None:
            rate, channels = standing.motion.frame_rate, standing.motion.channels[self.window]
            release_hands(
                standing.arms, standing.holds, standing.morphology, channels, rate, self.window, self._positions,
                self._rotations,
            )  # fmt: skip
        residuals = np.full((len(self._order) + len(self._clear), len(self._positions)), np.nan)
        residuals[self._order] = self._misses[self._held :]
        if self._clear:
            residuals[self._clear] = self._clearance[7]
        rows = slice(window.start - self.window.start, window.stop - self.window.start)
        return self._positions[rows], self._rotations[rows], residuals[:, rows]


def _known_tracks(
    standing: "Standing", constraints: Sequence[Constraint], window: slice, tracks: Tracks
) -> dict[Follow | Support, Track]:
    """What is followed and known before anything is solved, in the frames of ``window``."""
    known: dict[Follow | Support, Track] = {}
    for constraint in constraints:
        for follow in follows_of(constraint):
            if follow in tracks:
                known[follow] = tracks[follow].within(window)
            elif not isinstance(follow, FollowBody):
                raise StudioError(f"'{constraint.name}' follows something that is not there. Choose what it follows.")
        place = getattr(constraint, "place", None)
        if isinstance(place, Support):
            path = support_path(
                standing.positions, standing.rotations,
                standing_points(standing.contacts, standing.motion.frame_count), standing.morphology.still,
                standing.motion.frame_rate, place.margin, window,
            )  # fmt: skip
            known[place] = Track(path, np.broadcast_to(np.eye(3), (1, 3, 3)))
    return known


def _freedoms(
    standing: "Standing",
    window: slice,
    limbs: NDArray[np.int64],
    ranks: NDArray[np.int64],
    activations: FloatArray,
    bound: "Bound",
) -> FloatArray:
    """(L, 4, F) how far each limb is a balance's of a level to turn; ``limbs`` (C, 2) of the wishes, ``ranks`` (C,),
    ``activations`` (C, all).
    """
    contacts = standing.contacts if bound.by_contacts else ()
    free = limb_freedoms(limbs, ranks, activations, contacts, standing.motion.frame_rate)[:, :, window]
    free[:, 2:] *= leg_room(standing.morphology, standing.ground, standing.positions, window)
    return free


def legs_of(footing: Footing, window: slice) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Comforts, ankles, feet and toes of a stretch of frames, as kernels want them: contiguous."""
    return (
        np.ascontiguousarray(footing.comforts[:, window]),
        np.ascontiguousarray(footing.ankles[:, window]),
        np.ascontiguousarray(footing.feet[:, window]),
        np.ascontiguousarray(footing.toes[:, window]),
    )


def constraint_activations(
    constraints: Sequence[Constraint], contacts: Sequence[ContactInterval], motion: NormalizedMotion
) -> FloatArray:
    """(C, F) in [0, 1]; a constraint on a limb yields to that limb's contacts, which stand above all."""
    times = np.arange(motion.frame_count) / motion.frame_rate
    activations = np.array([constraint.activation.at(times) for constraint in constraints])
    standing = {contact.point.limb for contact in contacts}
    for row, constraint in zip(activations, constraints, strict=True):
        limb = limb_of(constraint.point.part)
        if limb >= 0 and limb in standing:
            row *= limb_freedom(contacts, limb, motion.frame_count, motion.frame_rate)
    return activations
