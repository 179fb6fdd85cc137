"""Constraints on a window of frames of a grounded motion: packed for the kernels, solved, and smoothed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from studio.core.body.joint_limits import limb_limit_records
from studio.core.body.morphology import at_frames
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow, FollowBody
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.target import follows_of, own_places_of
from studio.core.errors import StudioError
from studio.core.kernels import records
from studio.core.kernels.records import HAND_CONTACT, BalanceJoints, BodyFrames, ConstraintSet, MotionArrays
from studio.core.kernels.solve_clip import solve_frames
from studio.core.runs import runs_of
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.grounding.support_polygon import mass_path, standing_mask, support_path
from studio.core.solver.performers.followed_tracks import own_track
from studio.core.solver.smoothing.level_smoothing import (
    SMOOTHING_WIDTH_SECONDS,
    LevelNumbers,
    LevelSmoother,
    SolvedArrays,
    SolvedLevel,
    SolveNotes,
)
from studio.core.solver.smoothing.limb_coordinates import LimbCoordinates
from studio.core.solver.smoothing.smoothed_root_reach import RootReach
from studio.core.solver.smoothing.target_motion import target_accelerations
from studio.core.solver.task_assembly.chains import joints_of_chains, point_masses, relevant_chain, segment_masses
from studio.core.solver.task_assembly.clearance import activations_by_tier, lowest_first, pack_clearance
from studio.core.solver.task_assembly.contact_constraints import (
    contact_constraints,
    release_hands,
    write_contact_targets,
)
from studio.core.solver.task_assembly.contact_release import contact_release, is_ramped, ramped_target
from studio.core.solver.task_assembly.ground_limit import ground_planes, target_above_ground
from studio.core.solver.task_assembly.kinds.known import ENTERING_KINDS
from studio.core.solver.task_assembly.limb_availability import (
    arm_limit_fractions,
    leg_limit_fractions,
    limb_availability,
)
from studio.core.solver.task_assembly.packing import pack_tasks, priority_order
from studio.core.solver.task_assembly.self_contact import arm_activations
from studio.core.solver.task_assembly.shared_goals import share_goals
from studio.core.solver.task_assembly.tracks import OwnPath, Targets, Track, Tracks, raised_along_arms

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
_NONE = np.empty(0)


@dataclass(frozen=True)
class SolverLimits:
    """Restrictions of a body beside its constraints, each of which may be switched off."""

    uses_contacts: bool = True
    uses_joint_limits: bool = True
    uses_ground: bool = True


ALL_LIMITS = SolverLimits()


class SolvedWindow:
    """Solver of constraints on a window of frames of a grounded motion. The result does not depend on the window's
    width.
    """

    def __init__(
        self,
        standing: GroundedMotion,
        constraints: Sequence[Constraint],
        activations: FloatArray,
        tracks: Tracks,
        bound: SolverLimits,
        window: slice,
    ) -> None:
        """Pack the constraints; ``activations`` (C, F) and ``tracks`` cover the whole motion. StudioError if a target
        has no track.
        """
        body, footing = standing.morphology, standing.footing
        self.standing, self.window, self._asked = standing, window, (constraints, activations, tracks, bound)
        self._unsolved = standing.positions[window], standing.rotations[window]
        self._positions, self._rotations = self._unsolved[0].copy(), self._unsolved[1].copy()
        holds = standing.holds if bound.uses_contacts else ()
        held = contact_constraints(holds, footing, body, standing.positions, standing.rotations)
        self._held, self._clear = len(held), lowest_first(constraints)
        self._order = [c for c in priority_order(constraints) if c not in self._clear]
        asked, cleared = [constraints[c] for c in self._order], [constraints[c] for c in self._clear]
        everything = [*(each.constraint for each in held), *asked]
        self._rows = pack_tasks(everything, body.layout, targets_of(standing, constraints, window, tracks), self._held)
        acts = activations[self._order, window]
        if held:
            write_contact_targets(self._rows, held, window)
            stands = np.array([each.standing[window] for each in held])
            acts = np.concatenate([stands & (activations[:, window] > 0.0).any(axis=0), acts])
        self._activations = np.ascontiguousarray(acts)
        share_goals(self._rows, asked, self._held, acts)
        self._sunk = np.zeros(acts.shape)
        self._shares, self._targets = self._lead(asked)
        joints = joints_of_chains(tuple(map(relevant_chain, everything)), self._rows.levels, body.layout)
        self._joints = joints if bound.uses_joint_limits else joints.without_limits
        self._freedoms = self._find_freedoms(activations[self._order])
        self._missed = np.empty((len(everything) + len(cleared), len(self._positions)))
        self._clearance = pack_clearance(
            cleared, everything, self._held, activations[self._clear, window], self._missed[len(everything) :],
            standing, window,
        )  # fmt: skip
        if cleared:
            self._unsolved = self._positions.copy(), self._rotations.copy()
        root_reach = (
            footing.root_reaches[:, window] if bound.uses_contacts else np.full((2, len(self._positions)), np.inf)
        )
        self._root_reach = np.ascontiguousarray(root_reach)
        self._legs = footing.legs(standing.motion, window)
        limits = limb_limit_records(body.first_frame_body)[: 4 * (bound.uses_joint_limits and standing.limited)]
        masses, fractions = segment_masses(body.layout), point_masses(body.layout)
        measures = at_frames(body.rows, window)
        contacts = self._hand_contacts(window)
        ground = ground_planes(standing, window)
        self._body = BodyFrames(measures, masses, self._root_reach, self._legs, limits, fractions, contacts, ground)

    def _hand_contacts(self, window: slice) -> NDArray[np.void]:
        """Records ``HAND_CONTACT`` (2, F) of the hands, or (2, 1) without contacts."""
        contact = self.standing.self_contact
        return np.zeros((2, 1), HAND_CONTACT) if contact is None else contact.hand_contacts(window)

    def _lead(self, asked: Sequence[Constraint]) -> tuple[FloatArray, records.TargetArrays]:
        """Release fractions (C, F) of targets that begin at a contact, 1 for others, and all targets at these
        fractions.
        """
        fractions, free = np.ones(self._activations.shape), contact_release(asked, self.standing, self.window)
        places = list(self._rows.positions)
        for c, constraint in enumerate(asked, self._held):
            if is_ramped(constraint):
                fractions[c] = free[c - self._held]
                below = ramped_target(constraint, places[c], fractions[c], self.standing, self.window)
                places[c] = below
                if self._asked[-1].uses_ground:
                    places[c] = target_above_ground(constraint, below, self.standing, self.window)
                    self._sunk[c] = places[c][:, 2] - below[:, 2]
        return fractions, replace(self._rows, positions=places).stacked_targets

    def _find_freedoms(self, activations: FloatArray) -> FloatArray:
        """Availability (L, n, F) of each redundant limb to the balances of each level, from ``activations`` (C, F)."""
        if not len(self._joints.limbs):
            return np.zeros((0, 0, 1))
        standing, tasks, bound = self.standing, self._rows.tasks[self._held :], self._asked[-1]
        contacts, limbs = standing.contacts if bound.uses_contacts else (), tasks["limbs"]
        free = limb_availability(limbs, tasks["level"], activations, contacts, standing.motion.frame_rate)
        free = free[:, :, self.window]
        free[:, :2] *= arm_limit_fractions(standing.morphology, standing.positions, self.window)
        touching = self._hand_contacts(self.window)
        free[:, :2] *= 1.0 - np.maximum(touching["together"], touching["resting"])
        free[:, 2:] *= leg_limit_fractions(standing.morphology, standing.ground, standing.positions, self.window)
        return np.ascontiguousarray(free[:, self._joints.limbs])

    def solve(self, frames: IntArray | None = None) -> None:
        """Solve all frames of the window, or those with the indices ``frames`` (n,), each from its own pose."""
        self.whole = self._solve_of()
        noting = self.whole.noting
        self._pose(None, noting if frames is None else noting._replace(frames=frames))

    @property
    def may_exceed_peaks(self) -> bool:
        """True if a solved frame may exceed the allowed acceleration peaks of the highest level, which are the
        smallest.
        """
        highest = int(self._held > 0)
        peaks = self._solve_of(highest).peaks
        return self._hides_peaks() or (
            self.whole.exceeds_peaks(peaks)
            and self.whole.exceeds_peaks(peaks + self._brings_of(self._ranks <= highest)[:, None])
        )

    def _hides_peaks(self) -> bool:
        """True if a level may have acceleration peaks that vanish in the solution of all levels.

        This is possible with self-collision constraints or areas.
        """
        tasks = self._rows.tasks[self._held :]
        several = len(tasks) and tasks["level"][0] < tasks["level"][-1]
        return bool(self._clear or (several and np.isin(tasks["kind"], ENTERING_KINDS).any()))

    @cached_property
    def _ranks(self) -> IntArray:
        """Levels (C + Q,) of all constraints, 0 the highest: contacts first, self-collision constraints last."""
        constraints = self._asked[0]
        priorities = [constraints[c].priority for c in self._order + self._clear]
        return np.unique([-1] * self._held + priorities, return_inverse=True)[1]

    @property
    def _levels(self) -> int:
        """Number of levels."""
        return int(self._ranks.max()) + 1

    def _pose(self, level: int | None, easing: records.SmoothingRun) -> None:
        """Solve the constraints down to a ``level``, or all of them, for the frames and states of ``easing``."""
        rows, joints, acts, clearance = self._rows, self._joints, self._activations, self._clearance
        chain, usual = joints.kernel_weights, joints.nominal_weights
        if level is not None:
            stands, count = self._ranks <= level, len(rows.tasks)
            acts = np.where(stands[:count, None], acts, 0.0)
            down = count + self._rank_of(level + 1)  # what only levels below may move stays where it is
            chain = chain._replace(weights=chain.weights[:down])
            usual = np.concatenate([usual[:down], usual[-1:]])
            if self._clear:
                fractions = np.where(stands[count:, None], clearance.activations, 0.0)
                clearance = clearance._replace(activations=fractions)
        tiered = activations_by_tier(acts, self._clearance) if self._clear else acts[None]
        recruits = BalanceJoints(joints.recruited, usual, self._freedoms)
        asked = ConstraintSet(rows.tasks, rows.areas, chain, recruits, self._targets, tiered, rows.stacked_weights)
        motion = MotionArrays(*self._unsolved, self._positions, self._rotations)
        solve_frames(asked, self._body, motion, clearance, easing, self._missed[: len(rows.tasks)])

    def _rank_of(self, level: int) -> int:
        """Number of task levels above a ``level``; levels with self-collision constraints alone are not counted."""
        ranks = self._rows.tasks["level"]
        return int(ranks[self._ranks[: len(ranks)] < level].max(initial=-1)) + 1

    def _solve_of(self, level: int | None = None) -> SolveNotes:
        """``SolveNotes`` for a solve down to a ``level``, or of all levels."""
        ends, level = self._rows.tasks["limbs"], self._levels - 1 if level is None else level
        ends = ends[self._ranks[: len(ends)] <= level]
        return SolveNotes.of(self.standing, len(self._positions), self._joints.joints, ends, int(self._held > 0))

    def _runs(self, window: slice) -> list[tuple[int, int]]:
        """(first, past last) row of each run of frames that are smoothed together and are partly in ``window``."""
        first, last = window.start - self.window.start, window.stop - self.window.start
        return [run for run in runs_of(self._smoothing_weights[-1] > 0.0) if run[0] < last and run[1] > first]

    def with_smoothing_runs(self, window: slice) -> slice:
        """``window`` extended by all frames that affect its smoothing, as far as they are solved here."""
        first = self.window.start
        begins, ends = zip((window.start - first, window.stop - first), *self._runs(window), strict=True)
        return slice(first + min(begins), first + max(ends))

    def smooth_runs(self, window: slice) -> None:
        """Smooth acceleration peaks in ``window``, each run of smoothed frames by itself."""
        margin, first = self._smoothing_weights[-1], self.window.start
        beyond = round(max(SMOOTHING_WIDTH_SECONDS) * self.standing.motion.frame_rate)
        for begin, end in self._runs(window):
            wide = slice(max(begin - beyond, 0), min(end + beyond, len(margin)))
            frames = slice(first + wide.start, first + wide.stop)
            if frames == self.window:
                self._ease(self._solved_levels, self._smoothing_weights)
                return
            run = SolvedWindow(self.standing, *self._asked, frames)
            run._ease([level.in_frames(wide) for level in self._solved_levels], self._smoothing_weights[:, wide])
            mine, theirs = slice(begin, end), slice(begin - wide.start, end - wide.start)
            self._solved.in_frames(mine).copy_from(run._solved.in_frames(theirs))

    def has_smoothed_frames(self, window: slice) -> bool:
        """True if any frame of ``window`` is smoothed."""
        return bool(self._runs(window))

    @cached_property
    def _smoothing_weights(self) -> FloatArray:
        """Smoothing weights (L, F) of the levels, near acceleration peaks of their own or of higher levels; 0 for
        contacts.
        """
        levels, near = self._solved_levels, np.zeros(len(self._positions))
        rooms = np.zeros((len(levels), len(near)))
        for number in range(int(self._held > 0), len(levels)):
            near = np.maximum(near, levels[number].near_peaks)
            rooms[number] = near * levels[number].within_activity
        return rooms

    @cached_property
    def _solved_levels(self) -> list[SolvedLevel]:
        """Solution of each level together with those above it alone. That of the last level is known already."""
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
        self._solved.copy_from(last.solved)
        return [*levels, last]

    def _level(self, number: int, solve: SolveNotes) -> SolvedLevel:
        """``SolvedLevel`` of the level that was solved last."""
        down = self._ranks <= number
        fractions = [*self._activations, *(self._clearance.activations if self._clear else ())][self._held :]
        acting, ranks = np.reshape(fractions, (-1, len(self._positions))) > 0.0, self._ranks[self._held :]
        acts, own = (np.asarray(acting[each].any(axis=0)) for each in (ranks <= number, ranks == number))
        solved, above = SolvedArrays(*(each.copy() for each in self._solved)), self._ranks < number
        clears = int(np.count_nonzero(~above[len(self._activations) :]))
        allowed = solve.peaks + self._brings_of(down)[:, None]
        return SolvedLevel(solve, solved, above, LevelNumbers(self._rank_of(number), clears), acts, own, allowed)

    def _brings_of(self, down: NDArray[np.bool_]) -> FloatArray:
        """Angular accelerations (F,) in rad/s2 that moving targets of the constraints ``down`` (C + Q,) cause."""
        push, edges = self._brings[:, down[: len(self._activations)]]
        return np.asarray(push.sum(axis=0) + edges.max(axis=0, initial=0.0))

    @cached_property
    def _brings(self) -> FloatArray:
        """Angular accelerations (2, C, F) in rad/s2 that targets cause by their motion, and by their activation."""
        return target_accelerations(
            self._rows,
            self._held,
            self._activations * self._shares,
            *self._unsolved,
            self.standing.morphology.first_frame_body,
            self.standing.motion.frame_rate,
        )

    def _ease(self, levels: Sequence[SolvedLevel], rooms: FloatArray) -> None:
        """Smooth all ``levels`` with the smoothing weights ``rooms`` (L, F), in the arrays of this window."""
        measures, limits, ankles = self._body.measures, self._body.limits, self._legs.ankles
        layout = self.standing.morphology.layout
        root_reach = RootReach.of(self.standing.positions[self.window], measures, layout, ankles, self._root_reach)
        charts = LimbCoordinates(layout, self._unsolved[1], limits, levels[-1].solve.limbs)
        LevelSmoother(levels, self._pose, self._solved, charts, root_reach, rooms).smooth_levels()

    @property
    def _solved(self) -> SolvedArrays:
        """Arrays into which the kernels write."""
        cleared = self._unsolved if self._clear else (_NONE, _NONE)
        return SolvedArrays(self._positions, self._rotations, self._missed.T, *cleared)

    def arm_activations(self, window: slice) -> FloatArray:
        """Activations (F, 2, 2) of constraints and contacts on wrist and elbow of each arm, in the frames of
        ``window``.
        """
        rows, standing = slice(window.start - self.window.start, window.stop - self.window.start), self.standing
        asked = arm_activations(self._rows.tasks, self._activations[:, rows], standing.morphology)
        asked[:, :, 0] = np.maximum(asked[:, :, 0], 1.0 - standing.limb_freedoms[:2, window].T)
        return asked

    def solution(self, window: slice) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, rotations and residuals of the frames of ``window``."""
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
        """Residuals (C, F) in the given order of constraints, metres or radians.

        A target below the ground was raised to it. The distance by which it was raised is added at right angles to the
        residual of the raised target, because only the latter is held against lower constraints.
        """
        residuals = np.empty((len(self._order) + len(self._clear), len(self._positions)))
        residuals[self._order + self._clear] = self._missed[self._held :]
        residuals[self._order] = np.hypot(residuals[self._order], (self._activations * self._sunk)[self._held :])
        return residuals


def targets_of(standing: GroundedMotion, constraints: Sequence[Constraint], window: slice, tracks: Tracks) -> Targets:
    """Evaluation of the constraints' targets in the frames of ``window``, as far as they are known before solving."""
    motion, body = standing.motion, standing.morphology.first_frame_body
    known: dict[Follow | OwnPlace | Support, Track] = {}
    for constraint in constraints:
        for place in own_places_of(constraint):
            known[place] = own_track(place, standing.unconstrained, standing.morphology, motion.frame_rate)
        for follow in follows_of(constraint):
            track = tracks.get(follow)
            if isinstance(track, OwnPath):
                track = track.make(standing.unconstrained, standing.morphology)
            if track is not None:
                known[follow] = raised_along_arms(
                    follow, track.in_frames(window), standing.positions[window], body.layout
                )
            elif not isinstance(follow, FollowBody):
                raise StudioError(
                    f"'{constraint.name}' follows something that no longer exists. Choose another target."
                )
        if isinstance(constraint, BalanceConstraint) and isinstance(constraint.place, Support):
            path = support_path(
                standing.positions, standing.rotations, standing_mask(standing.contacts, motion.frame_count), body,
                motion.frame_rate, constraint.place.margin, window,
            )  # fmt: skip
            known[constraint.place] = Track(path, np.broadcast_to(np.eye(3), (1, 3, 3)))
    masses = partial(mass_path, standing.positions[window], body)
    return Targets(motion.times[window], known, masses, standing.morphology.leg_length)
