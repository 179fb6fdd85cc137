"""A window of a standing motion with its constraints: packed for the kernels, solved, and eased where that jolts."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from studio.core.body.joint_limits import limits_of
from studio.core.body.morphology import at_frames
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow, FollowBody
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.target import follows_of, own_places_of
from studio.core.errors import StudioError
from studio.core.kernels import records
from studio.core.kernels.records import BodyFrames, ConstraintSet, MotionArrays, RedundancyGroups
from studio.core.kernels.solve_clip import solve_frames
from studio.core.runs import runs_of
from studio.core.solver.asking.chains import carrying_chain, free_joints, point_masses, segment_masses
from studio.core.solver.asking.clearance import down_to_tiers, lowest_first, pack_clearance
from studio.core.solver.asking.holding import held_points, place_held, release_hands
from studio.core.solver.asking.kinds.known import ENTERING
from studio.core.solver.asking.packing import in_order, pack
from studio.core.solver.asking.recruiting import arm_lever, leg_room, limb_freedoms
from studio.core.solver.asking.releasing import is_led, led_place, limb_shares
from studio.core.solver.asking.self_contact import arms_asked
from studio.core.solver.asking.tracks import OwnPath, Targets, Track, Tracks
from studio.core.solver.performers.following import own_track
from studio.core.solver.smoothing.easing import WIDTHS, Easing, Level, Rank, Solve, Solved
from studio.core.solver.smoothing.limb_charts import LimbCharts
from studio.core.solver.smoothing.root_reach import RootReach
from studio.core.solver.smoothing.target_motion import brought
from studio.core.solver.standing.stand import Standing
from studio.core.solver.standing.support import mass_path, standing_points, support_path

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
_NONE = np.empty(0)


@dataclass(frozen=True)
class Bound:
    """By what a body is bound beside its constraints."""

    by_contacts: bool = True
    by_limits: bool = True


BOUND = Bound()


class SolvedWindow:
    """Constraints on the frames of ``window``; nothing else depends on how wide that is."""

    def __init__(
        self,
        standing: Standing,
        constraints: Sequence[Constraint],
        activations: FloatArray,
        tracks: Tracks,
        bound: Bound,
        window: slice,
    ) -> None:
        """``activations`` (C, F) and ``tracks`` of the whole motion; StudioError where these lack what is followed."""
        body, footing = standing.morphology, standing.footing
        self.standing, self.window, self._asked = standing, window, (constraints, activations, tracks, bound)
        self._unsolved = standing.positions[window], standing.rotations[window]
        self._positions, self._rotations = self._unsolved[0].copy(), self._unsolved[1].copy()
        holds = standing.holds if bound.by_contacts else ()
        held = held_points(holds, footing, body, standing.positions, standing.rotations)
        self._held, self._clear = len(held), lowest_first(constraints)
        self._order = [c for c in in_order(constraints) if c not in self._clear]
        asked, cleared = [constraints[c] for c in self._order], [constraints[c] for c in self._clear]
        everything = [*(each.constraint for each in held), *asked]
        self._rows = pack(everything, body.layout, targets_of(standing, constraints, window, tracks), self._held)
        acts = activations[self._order, window]
        if held:
            place_held(self._rows, held, window)
            stands = np.array([each.standing[window] for each in held])
            acts = np.concatenate([stands & (activations[:, window] > 0.0).any(axis=0), acts])
        self._activations = np.ascontiguousarray(acts)
        self._shares, self._targets = self._lead(asked)
        joints = free_joints(tuple(map(carrying_chain, everything)), self._rows.ranks, body.layout)
        self._joints = joints if bound.by_limits else joints.without_limits
        self._freedoms = self._find_freedoms(activations[self._order])
        self._missed = np.empty((len(everything) + len(cleared), len(self._positions)))
        self._clearance = pack_clearance(
            cleared, everything, self._held, activations[self._clear, window], self._missed[len(everything) :],
            standing, window,
        )  # fmt: skip
        if cleared:
            self._unsolved = self._positions.copy(), self._rotations.copy()
        root_reach = (
            footing.root_reaches[:, window] if bound.by_contacts else np.full((2, len(self._positions)), np.inf)
        )
        self._root_reach = np.ascontiguousarray(root_reach)
        self._legs = footing.legs(standing.motion, window)
        limits = limits_of(body.still)[: 4 * (bound.by_limits and standing.limited)]
        masses, shares = segment_masses(body.layout), point_masses(body.layout)
        measures = at_frames(body.rows, window)
        self._body = BodyFrames(measures, masses, self._root_reach, self._legs, limits, shares)

    def _lead(self, asked: Sequence[Constraint]) -> tuple[FloatArray, records.TargetArrays]:
        """(C, F) how far targets that are led are on their way, 1 for others, and all targets as they are then."""
        shares, free = np.ones(self._activations.shape), limb_shares(asked, self.standing, self.window)
        places = list(self._rows.places)
        for c, constraint in enumerate(asked, self._held):
            if is_led(constraint):
                shares[c] = free[c - self._held]
                places[c] = led_place(constraint, places[c], shares[c], self.standing, self.window)
        return shares, replace(self._rows, places=places).stacked_targets

    def _find_freedoms(self, activations: FloatArray) -> FloatArray:
        """(L, n, F) how far each limb that may be recruited is a balance's of a level to turn, of what acts (C, F)."""
        if not len(self._joints.limbs):
            return np.zeros((0, 0, 1))
        standing, tasks, bound = self.standing, self._rows.asked[self._held :], self._asked[-1]
        contacts, limbs = standing.contacts if bound.by_contacts else (), tasks["limbs"]
        free = limb_freedoms(limbs, tasks["level"], activations, contacts, standing.motion.frame_rate)
        free = free[:, :, self.window]
        free[:, :2] *= arm_lever(standing.morphology, standing.positions, self.window)
        free[:, 2:] *= leg_room(standing.morphology, standing.ground, standing.positions, self.window)
        return np.ascontiguousarray(free[:, self._joints.limbs])

    def solve(self, frames: IntArray | None = None) -> None:
        """Solve every frame, or some of them (n,), from its own pose."""
        self.whole = self._solve_of()
        noting = self.whole.noting
        self._pose(None, noting if frames is None else noting._replace(frames=frames))

    @property
    def may_jolt(self) -> bool:
        """Whether anything may, of all frames as they are solved: beyond what the highest level is allowed, which is
        less than what others are.
        """
        highest = int(self._held > 0)
        peaks = self._solve_of(highest).peaks
        return self._hides_jolts() or (
            self.whole.jolts(peaks) and self.whole.jolts(peaks + self._brings_of(self._ranks <= highest)[:, None])
        )

    def _hides_jolts(self) -> bool:
        """Whether a level may jolt that does not with those below it: where arms are kept clear, points enter areas and
        leave them.
        """
        tasks = self._rows.asked[self._held :]
        several = len(tasks) and tasks["level"][0] < tasks["level"][-1]
        return bool(self._clear or (several and np.isin(tasks["kind"], ENTERING).any()))

    @cached_property
    def _ranks(self) -> IntArray:
        """(C + Q,) the levels of all that is asked, contacts first, those that keep clear last."""
        constraints = self._asked[0]
        priorities = [constraints[c].priority for c in self._order + self._clear]
        return np.unique([-1] * self._held + priorities, return_inverse=True)[1]

    @property
    def _levels(self) -> int:
        return int(self._ranks.max()) + 1

    def _pose(self, level: int | None, easing: records.SmoothingRun) -> None:
        """Solve, or pose as eased, with the constraints down to a ``level``, or with all."""
        rows, joints, acts, clearance = self._rows, self._joints, self._activations, self._clearance
        chain, usual = joints.chain, joints.nominal_weights
        if level is not None:
            stands, count = self._ranks <= level, len(rows.asked)
            acts = np.where(stands[:count, None], acts, 0.0)
            down = count + self._rank_of(level + 1)  # what only levels below may move stays where it is
            chain = chain._replace(weights=chain.weights[:down])
            usual = np.concatenate([usual[:down], usual[-1:]])
            if self._clear:
                shares = np.where(stands[count:, None], clearance.activations, 0.0)
                clearance = clearance._replace(activations=shares)
        tiered = down_to_tiers(acts, self._clearance) if self._clear else acts[None]
        recruits = RedundancyGroups(joints.recruited, usual, self._freedoms)
        asked = ConstraintSet(rows.asked, rows.areas, chain, recruits, self._targets, tiered)
        motion = MotionArrays(*self._unsolved, self._positions, self._rotations)
        solve_frames(asked, self._body, motion, clearance, easing, self._missed[: len(rows.asked)])

    def _rank_of(self, level: int) -> int:
        """How many levels stand above one, but for those that only keep clear."""
        ranks = self._rows.asked["level"]
        return int(ranks[self._ranks[: len(ranks)] < level].max(initial=-1)) + 1

    def _solve_of(self, level: int | None = None) -> Solve:
        """To note what is solved down to a ``level``, or of all."""
        ends, joints = self._rows.asked["limbs"], self._joints
        level = self._levels - 1 if level is None else level
        mobilities = joints.weights[: len(ends) + self._rank_of(level + 1)]
        moved, ends = np.asarray(mobilities[len(ends) :].any(axis=0)), ends[self._ranks[: len(ends)] <= level]
        return Solve.of(self.standing, len(self._positions), joints.joints, moved, ends, int(self._held > 0))

    def _runs(self, window: slice) -> list[tuple[int, int]]:
        """First and past the last row of each run of frames that have to do with each other and touch ``window``."""
        first, last = window.start - self.window.start, window.stop - self.window.start
        return [run for run in runs_of(self._rooms[-1] > 0.0) if run[0] < last and run[1] > first]

    def with_runs(self, window: slice) -> slice:
        """``window`` and all frames that have to do with how any of it is eased, as far as they are solved here."""
        first = self.window.start
        begins, ends = zip((window.start - first, window.stop - first), *self._runs(window), strict=True)
        return slice(first + min(begins), first + max(ends))

    def ease(self, window: slice) -> None:
        """Ease what jolts in ``window``: each run of frames that have to do with each other by itself."""
        room, first = self._rooms[-1], self.window.start
        beyond = round(max(WIDTHS) * self.standing.motion.frame_rate)
        for begin, end in self._runs(window):
            wide = slice(max(begin - beyond, 0), min(end + beyond, len(room)))
            frames = slice(first + wide.start, first + wide.stop)
            if frames == self.window:
                self._ease(self._solved_levels, self._rooms)
                return
            run = SolvedWindow(self.standing, *self._asked, frames)
            run._ease([level.within(wide) for level in self._solved_levels], self._rooms[:, wide])
            mine, theirs = slice(begin, end), slice(begin - wide.start, end - wide.start)
            self._solved.within(mine).put(run._solved.within(theirs))

    def eases(self, window: slice) -> bool:
        """Whether anything in ``window`` is to be eased."""
        return bool(self._runs(window))

    @cached_property
    def _rooms(self) -> FloatArray:
        """(L, F) how far levels may be eased: nowhere less than those above them, or these would not stay as they are.

        Contacts are not.
        """
        first, levels = int(self._held > 0), self._solved_levels
        rooms = np.zeros((len(levels), len(self._positions)))
        for number in range(first, len(levels)):
            rooms[number] = np.maximum(rooms[number - 1] if number else 0.0, levels[number].room)
        return rooms

    @cached_property
    def _solved_levels(self) -> list[Level]:
        """Every level with those above it, as it is solved without others; the last is solved already."""
        last = self._level(self._levels - 1, self.whole)
        levels = []
        for number in range(self._levels - 1):
            solve = self._solve_of(number)
            before = self.standing.positions[self.window], self.standing.rotations[self.window]
            self._positions[:], self._rotations[:] = before
            if self._clear:
                self._unsolved[0][:], self._unsolved[1][:] = before
            self._pose(number, solve.noting)
            levels.append(self._level(number, solve))
        self._solved.put(last.solved)
        return [*levels, last]

    def _level(self, number: int, solve: Solve) -> Level:
        """A level that was just solved."""
        down = self._ranks <= number
        shares = [*self._activations, *(self._clearance.activations if self._clear else ())][self._held :]
        acting, ranks = np.reshape(shares, (-1, len(self._positions))) > 0.0, self._ranks[self._held :]
        acts, own = (np.asarray(acting[each].any(axis=0)) for each in (ranks <= number, ranks == number))
        solved, above = Solved(*(each.copy() for each in self._solved)), self._ranks < number
        clears = int(np.count_nonzero(~above[len(self._activations) :]))
        allowed = solve.peaks + self._brings_of(down)[:, None]
        return Level(solve, solved, above, Rank(self._rank_of(number), clears), acts, own, allowed)

    def _brings_of(self, down: NDArray[np.bool_]) -> FloatArray:
        """(F,) what the constraints ``down`` (C + Q,) to a level bring, radians a second squared."""
        push, edges = self._brings[:, down[: len(self._activations)]]
        return np.asarray(push.sum(axis=0) + edges.max(axis=0, initial=0.0))

    @cached_property
    def _brings(self) -> FloatArray:
        return brought(
            self._rows, self._held, self._activations * self._shares, *self._unsolved, self.standing.morphology.still,
            self.standing.motion.frame_rate,
        )  # fmt: skip

    def _ease(self, levels: Sequence[Level], rooms: FloatArray) -> None:
        measures, limits, ankles = self._body.measures, self._body.limits, self._legs.ankles
        layout = self.standing.morphology.layout
        root_reach = RootReach.of(self.standing.positions[self.window], measures, layout, ankles, self._root_reach)
        charts = LimbCharts(layout, self._unsolved[1], limits, levels[-1].solve.limbs)
        Easing(levels, self._pose, self._solved, charts, root_reach, rooms).ease()

    @property
    def _solved(self) -> Solved:
        cleared = self._unsolved if self._clear else (_NONE, _NONE)
        return Solved(self._positions, self._rotations, self._missed.T, *cleared)

    def arms_asked(self, window: slice) -> FloatArray:
        """(F, 2, 2) how far constraints and contacts have the wrist, and the elbow, of each arm in some frames."""
        rows = slice(window.start - self.window.start, window.stop - self.window.start)
        return arms_asked(self._rows.asked, self._activations[:, rows], self.standing.morphology)

    def answer(self, window: slice) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, rotations and residuals of some of its frames."""
        standing = self.standing
        if standing.arms is not None:
            rate, channels = standing.motion.frame_rate, standing.motion.channels[self.window]
            release_hands(
                standing.arms, standing.holds, standing.morphology, channels, rate, self.window, self._positions,
                self._rotations,
            )  # fmt: skip
        rows = slice(window.start - self.window.start, window.stop - self.window.start)
        return self._positions[rows], self._rotations[rows], self.residuals[:, rows]

    @property
    def residuals(self) -> FloatArray:
        """(C, F) by how much each constraint is missed, metres or radians, in the order in which they were given."""
        residuals = np.empty((len(self._order) + len(self._clear), len(self._positions)))
        residuals[self._order + self._clear] = self._missed[self._held :]
        return residuals


def targets_of(standing: Standing, constraints: Sequence[Constraint], window: slice, tracks: Tracks) -> Targets:
    """What gives the constraints' targets their numbers: all that is known before anything is solved."""
    motion, body = standing.motion, standing.morphology.still
    known: dict[Follow | OwnPlace | Support, Track] = {}
    for constraint in constraints:
        for place in own_places_of(constraint):
            known[place] = own_track(place, standing.unasked, standing.morphology, motion.frame_rate)
        for follow in follows_of(constraint):
            track = tracks.get(follow)
            if isinstance(track, OwnPath):
                track = track.make(standing.unasked, standing.morphology)
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
