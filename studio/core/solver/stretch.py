"""A stretch of a standing motion with its constraints: packed for the kernels, solved, and eased where that jolts."""

from collections.abc import Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.balance import BalanceConstraint, Support
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
from studio.core.solver.chains import carrying_chain, free_joints, point_masses, segment_masses
from studio.core.solver.clearance import down_to_stages, lowest_first, pack_clearance
from studio.core.solver.easing import WIDTHS, Easing, EasingArrays, Level, Solve, reach_of
from studio.core.solver.footing import Footing
from studio.core.solver.holding import held_points, place_held, release_hands
from studio.core.solver.packing import in_order, limb_of, pack
from studio.core.solver.recruiting import leg_room, limb_freedoms
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
        body, footing = standing.morphology, standing.footing
        self.standing, self.window, self._asked = standing, window, (constraints, tracks, bound)
        self._unsolved = standing.positions[window], standing.rotations[window]
        self._positions, self._rotations = self._unsolved[0].copy(), self._unsolved[1].copy()
        holds = standing.holds if bound.by_contacts else ()
        held = held_points(holds, footing, body, standing.positions, standing.rotations)
        self._held, self._clear = len(held), lowest_first(constraints)
        self._order = [c for c in in_order(constraints) if c not in self._clear]
        asked, cleared = [constraints[c] for c in self._order], [constraints[c] for c in self._clear]
        everything = [*(each.constraint for each in held), *asked]
        self._rows = pack(everything, body.layout, _targets(standing, constraints, window, tracks), self._held)
        activations = constraint_activations([*asked, *cleared], standing.contacts, standing.motion)
        acts = activations[: len(asked), window]
        if held:
            place_held(self._rows, held, window)
            stands = np.array([each.standing[window] for each in held])
            acts = np.concatenate([stands & (activations[:, window] > 0.0).any(axis=0), acts])
        self._activations, self._wishes = np.ascontiguousarray(acts), self._rows.wishes
        self._levels = max(self._rows.ranks, default=-1) + 1
        joints = free_joints(tuple(map(carrying_chain, everything)), self._rows.ranks, body.layout)
        self._joints = joints if bound.by_limits else joints.without_limits
        self._freedoms = self._find_freedoms(activations[: len(asked)])
        self._clearance = pack_clearance(
            cleared, everything, self._held, activations[len(asked) :, window],
            standing.motion, window, standing.actor, standing.volume, body.still,
        )  # fmt: skip
        if cleared:
            self._unsolved = self._positions.copy(), self._rotations.copy()
        leash = footing.leashes[:, window] if bound.by_contacts else np.full((2, len(self._positions)), np.inf)
        self._leash = np.ascontiguousarray(leash)
        self._stance = standing.motion.channels[window], *legs_of(footing, window)
        limits = limits_of(body.still)[: 4 * (bound.by_limits and standing.limited)]
        masses = segment_masses(body.layout), point_masses(body.layout)
        self._body = at_frames(body.rows, window), *masses, limits
        self._misses = np.empty(self._activations.shape)

    def _find_freedoms(self, activations: FloatArray) -> FloatArray:
        """(L, n, F) how far each limb that may be recruited is a balance's of a level to turn, of what acts (C, F)."""
        if not len(self._joints.limbs):
            return np.zeros((0, 0, 1))
        standing, wishes, (_, _, bound) = self.standing, self._rows.asked[self._held :], self._asked
        contacts, limbs = standing.contacts if bound.by_contacts else (), wishes["ends"][:, :, 2]
        free = limb_freedoms(limbs, wishes["rank"], activations, contacts, standing.motion.frame_rate)
        free = free[:, :, self.window]
        free[:, 2:] *= leg_room(standing.morphology, standing.ground, standing.positions, self.window)
        return np.ascontiguousarray(free[:, self._joints.limbs])

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
        rows, joints, acts = self._rows, self._joints, self._activations
        (mobilities, *others), usual = joints.arrays, joints.usual
        if level < self._levels - 1:
            acts = np.where(rows.asked["rank"][:, None] <= level, acts, 0.0)
            down = len(rows.asked) + level + 1  # what only levels below may move stays where it is
            mobilities, usual = mobilities[:down], np.concatenate([usual[:down], usual[-1:]])
        staged = down_to_stages(acts, self._clearance) if self._clear else acts[None]
        solve_frames(
            rows.asked, rows.areas, (mobilities, *others), (joints.recruited, usual, self._freedoms),
            self._wishes, staged, self._leash, self._stance, self._body, self._clearance, *self._unsolved,
            easing, self._misses, self._positions, self._rotations,
        )  # fmt: skip

    def _solve_of(self, level: int) -> Solve:
        """To note what is solved down to ``level``."""
        ends = self._rows.asked["ends"][:, :, 2]
        if level < self._levels - 1:
            ends = ends[self._rows.asked["rank"] <= level]
        motion, layout = self.standing.motion, self.standing.morphology.layout
        frames, joints = len(self._positions), self._joints.joints
        return Solve.of(layout, motion.frame_rate, frames, joints, ends, int(self._held > 0))

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
        (measures, _, _, limits), ankles, layout = self._body, self._stance[2], self.standing.morphology.layout
        leash = RootLeash.of(self.standing.positions[self.window], measures, layout, ankles, self._leash)
        levels = [self._level(number) for number in range(self._levels)]
        Easing(levels, self._solve_anew, self._pose, motion, self._misses, limits, leash, room).ease()

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
        residuals = np.empty((len(self._order) + len(self._clear), len(self._positions)))
        residuals[self._order] = self._misses[self._held :]
        if self._clear:
            residuals[self._clear] = self._clearance[7]
        rows = slice(window.start - self.window.start, window.stop - self.window.start)
        return self._positions[rows], self._rotations[rows], residuals[:, rows]


def _targets(standing: "Standing", constraints: Sequence[Constraint], window: slice, tracks: Tracks) -> Targets:
    """What gives the constraints' targets their numbers: all that is known before anything is solved."""
    motion, body = standing.motion, standing.morphology.still
    known: dict[Follow | Support, Track] = {}
    for constraint in constraints:
        for follow in follows_of(constraint):
            track = tracks.get(follow)
            if track is not None:
                known[follow] = track.within(window)
            elif not isinstance(follow, FollowBody):
                raise StudioError(f"'{constraint.name}' follows something that is not there. Choose what it follows.")
        if isinstance(constraint, BalanceConstraint) and isinstance(constraint.place, Support):
            path = support_path(
                standing.positions, standing.rotations, standing_points(standing.contacts, motion.frame_count), body,
                motion.frame_rate, constraint.place.margin, window,
            )  # fmt: skip
            known[constraint.place] = Track(path, np.broadcast_to(np.eye(3), (1, 3, 3)))
    return Targets(motion.times[window], known, partial(mass_path, standing.positions[window], body))


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
    activations = np.empty((len(constraints), motion.frame_count))
    standing = {contact.point.limb for contact in contacts}
    for row, constraint in zip(activations, constraints, strict=True):
        curve = constraint.activation
        row[:] = 1.0 if curve.is_whole(0.0, motion.duration) else curve.at(motion.times)
        limb = limb_of(constraint.point.part)
        if limb >= 0 and limb in standing:
            row *= limb_freedom(contacts, limb, motion.frame_count, motion.frame_rate)
    return activations
