"""Dependency cycles: performers who follow each other, solved by Jacobi iterations.

All performers are solved again from the last poses of all, until no followed point moves. Two points that follow each
other meet between them, by the weights of their constraints; if one cannot get there, the other comes nearer.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.follow import FollowPerformer, FollowProp
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.target import follows_of
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.normalized.compose import Composite
from studio.core.solver.performers.anticipated_targets import with_anticipated_targets, with_expected_positions
from studio.core.solver.performers.stage import leader_track
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.tracks import Track, Tracks
from studio.core.stage.placement import Placement
from studio.core.stage.prop import Prop

FloatArray = NDArray[np.float64]
SolveMember = Callable[[str, AdaptRequest], AdaptedMotion]
"""Function that solves one performer of the cycle, by its id."""

JACOBI_ITERATIONS = 10
"""Greatest number of iterations over a cycle."""
JACOBI_CONTRACTION = 0.6
"""Greatest ratio of successive displacements; where it is exceeded, the displacement is halved, which stops a chase."""
EVEN_RESIDUAL_METRES = 1e-4
"""Residual in metres of both ends of a meeting below which neither end dominates."""


@dataclass(frozen=True, eq=False)
class CycleMember:
    """One performer of a dependency cycle: its request without the tracks of the other members, and its placement."""

    request: AdaptRequest
    composite: Composite
    placement: Placement
    props: Mapping[str, Prop] = field(default_factory=dict)
    """All props that the performer may follow, by id."""
    frame: int | None = None
    """The one frame of the performer's motion to be solved; None for all."""
    expected: Mapping[FollowPerformer, FloatArray] = field(default_factory=dict)
    """Positions (3,) of anticipated performers in that frame, in the motion's space of this performer."""

    @cached_property
    def times(self) -> FloatArray:
        """Seconds (F,) of the performer's motion to be solved."""
        frames = np.arange(self.composite.motion.frame_count) if self.frame is None else np.array([self.frame])
        return np.asarray(frames / self.composite.timing.frame_rate)


Paths = Mapping[tuple[str, FollowPerformer | FollowProp], Track]
"""Tracks of followed performers and props, by the id of the follower and the followed target."""


@dataclass(frozen=True)
class MutualFollow:
    """Two position constraints of two performers that follow each other's points."""

    keys: tuple[str, str]
    """Ids of the performers."""
    rows: tuple[int, int]
    """Indices of the constraints in the performers' requests."""


@dataclass(frozen=True, eq=False)
class CycleSolution:
    """Solution of a dependency cycle."""

    results: Mapping[str, AdaptedMotion]
    """Adapted motions by performer."""
    requests: Mapping[str, AdaptRequest]
    """Last requests by performer."""
    paths: Paths
    """Tracks of all followed points in the last requests."""
    iterations: int
    """Number of iterations."""


def solve_cycle(
    players: Mapping[str, CycleMember],
    solve: SolveMember,
    expected: Paths = MappingProxyType({}),
    sweeps: int = JACOBI_ITERATIONS,
) -> CycleSolution:
    """Solve performers who follow each other, from their grounded poses, or from ``expected`` tracks of an earlier
    solution.
    """
    meetings = mutual_follows(players)
    requests = {key: each.request for key, each in players.items()}
    if expected:
        requests = {key: _following_paths(key, each, expected) for key, each in players.items()}
        results = {key: solve(key, request) for key, request in requests.items()}
    else:
        results = {key: solve(key, replace(request, constraints=())) for key, request in requests.items()}
    before, last = dict(expected), math.inf
    for sweep in range(sweeps):
        tracks = dict(paths_of(players, results))
        for meeting in meetings:
            _meet(meeting, players, results, before, tracks)
        moved = _moved(players, before, tracks) if before else math.inf
        if moved < PRIORITY_TOLERANCE:
            return _solution(players, results, requests, before, sweep)
        if sweep > 1 and moved > JACOBI_CONTRACTION * last:
            tracks = {key: _halfway(before[key], track) for key, track in tracks.items()}
        requests = {key: _following_paths(key, each, tracks) for key, each in players.items()}
        results = {key: solve(key, request) for key, request in requests.items()}
        before, last = tracks, moved
    return _solution(players, results, requests, before, sweeps)


def _solution(
    players: Mapping[str, CycleMember],
    results: Mapping[str, AdaptedMotion],
    requests: Mapping[str, AdaptRequest],
    paths: Paths,
    sweeps: int,
) -> CycleSolution:
    """``CycleSolution`` with residuals measured on the final poses of all performers.

    The solver's own residuals refer to the poses at the start of the last iteration.
    """
    from studio.core.solver.task_assembly.measured_residuals import with_residuals_remeasured

    final = dict(paths_of(players, results))
    requests = {
        key: replace(request, final_tracks=_own_tracks(key, players[key], final)) for key, request in requests.items()
    }
    results = {key: with_residuals_remeasured(result, requests[key]) for key, result in results.items()}
    return CycleSolution(results, requests, paths, sweeps)


def _following_paths(key: str, player: CycleMember, paths: Paths) -> AdaptRequest:
    """Request of a performer with the tracks that it follows in ``paths``."""
    return replace(player.request, tracks={**player.request.tracks, **_own_tracks(key, player, paths)})


def _own_tracks(key: str, player: CycleMember, paths: Paths) -> Tracks:
    """Tracks of ``paths`` that one performer follows, with anticipated targets."""
    own: Tracks = {follow: track for (whose, follow), track in paths.items() if whose == key}
    own = with_expected_positions(own, player.expected)
    return with_anticipated_targets(own, player.request.constraints, player.composite.timing.frame_rate)


def mutual_follows(players: Mapping[str, CycleMember]) -> tuple[MutualFollow, ...]:
    """Pairs of position constraints of two performers that follow each other's points."""
    found = []
    for one, other in combinations(players, 2):
        for row, first in _following(players[one], other):
            for column, second in _following(players[other], one):
                if _target(first).point == second.point and _target(second).point == first.point:
                    found.append(MutualFollow((one, other), (row, column)))
    return tuple(found)


def _following(player: CycleMember, leader: str) -> Iterable[tuple[int, PositionConstraint]]:
    """(index, constraint) of each position constraint of a performer that follows ``leader``."""
    for row, each in enumerate(player.request.constraints):
        target = each.target if isinstance(each, PositionConstraint) else None
        if isinstance(target, FollowPerformer) and target.performer_id == leader:
            assert isinstance(each, PositionConstraint)
            yield row, each


def _target(constraint: PositionConstraint) -> FollowPerformer:
    """Followed point of another performer that is a position constraint's target."""
    assert isinstance(constraint.target, FollowPerformer)
    return constraint.target


def paths_of(
    players: Mapping[str, CycleMember], results: Mapping[str, AdaptedMotion]
) -> Iterable[tuple[tuple[str, FollowPerformer | FollowProp], Track]]:
    """((follower, target), track) of everything in ``results`` that members of the cycle follow."""
    for key, player in players.items():
        for follow in {follow for each in player.request.constraints for follow in follows_of(each)}:
            if isinstance(follow, FollowProp) and player.props[follow.prop_id].holders & (players.keys() - {key}):
                yield (key, follow), _prop_path(follow, player, players, results)
            if isinstance(follow, FollowPerformer) and follow.performer_id in players:
                leader = players[follow.performer_id]
                places = leader.placement, player.placement
                seconds, timing = player.composite.timing.begin + player.times, leader.composite.timing
                track = leader_track(follow, results[follow.performer_id], timing, seconds, *places)
                yield (key, follow), track


def _prop_path(
    follow: FollowProp, player: CycleMember, players: Mapping[str, CycleMember], results: Mapping[str, AdaptedMotion]
) -> Track:
    """Track of a prop held by other members of the cycle, in the space of the performer that follows it."""
    from studio.core.solver.performers.prop_tracks import Holder, stage_track, track_in_motion_space

    prop, seconds = player.props[follow.prop_id], player.composite.timing.begin + player.times
    hands = {}
    for key in prop.holders & players.keys():
        timing, result = players[key].composite.timing, results[key]
        rows = timing.frames_at(seconds) - result.first_frame
        hands[key] = Holder(result, rows, players[key].placement, timing=timing)
    return track_in_motion_space(follow, prop, stage_track(prop, seconds, hands), player.placement)


def _meet(
    meeting: MutualFollow,
    players: Mapping[str, CycleMember],
    results: Mapping[str, AdaptedMotion],
    before: Paths,
    tracks: dict[tuple[str, FollowPerformer | FollowProp], Track],
) -> None:
    """Write the meeting point of two mutually following points into ``tracks``.

    At first it lies between them by the weights of the constraints; later it moves towards the one that did not arrive.
    """
    for first in (True, False):
        me, row = (meeting.keys[0], meeting.rows[0]) if first else (meeting.keys[1], meeting.rows[1])
        other, column = (meeting.keys[1], meeting.rows[1]) if first else (meeting.keys[0], meeting.rows[0])
        asked, theirs = players[me].request.constraints[row], players[other].request.constraints[column]
        assert isinstance(asked, PositionConstraint)
        follow = _target(asked)
        mine, other_place = _point(players[me], results[me], asked), tracks[me, follow].positions
        times = players[me].times
        theirs_times = times + _apart(players[me], players[other])
        if (me, follow) not in before:
            own, their = asked.weights_at(times)[:, None], theirs.weights_at(theirs_times)[:, None]
            place = mine + own / (own + their) * (other_place - mine)
        else:
            place = before[me, follow].positions
            held = asked.activation.at(times)[:, None] ** 3
            held_there = theirs.activation.at(theirs_times)[:, None] ** 3
            residual, miss_there = held * (mine - place), held_there * (other_place - place)
            far, far_there = (np.linalg.norm(each, axis=1, keepdims=True) for each in (residual, miss_there))
            place = place + (far * residual + far_there * miss_there) / (far + far_there + EVEN_RESIDUAL_METRES)
        tracks[me, follow] = Track(place, tracks[me, follow].rotations)


def _point(player: CycleMember, result: AdaptedMotion, constraint: PositionConstraint) -> FloatArray:
    """Positions (F, 3) of a performer's constrained point, in its motion's space."""
    from studio.core.solver.adapt import body_point_positions

    return body_point_positions(constraint.point, result)


def _apart(player: CycleMember, other: CycleMember) -> float:
    """Seconds to be added to times of ``player``'s motion to get times of ``other``'s."""
    return player.composite.timing.begin - other.composite.timing.begin


def _moved(
    players: Mapping[str, CycleMember],
    before: Paths,
    after: Paths,
) -> float:
    """Greatest displacement in metres of followed points between two iterations, weighted by activation."""
    moved = 0.0
    for (key, follow), track in after.items():
        displacements = np.linalg.norm(track.positions - before[key, follow].positions, axis=1)
        for each in players[key].request.constraints:
            if follow in follows_of(each):
                moved = max(moved, float((displacements * each.activation.at(players[key].times)).max(initial=0.0)))
    return moved


def _halfway(before: Track, after: Track) -> Track:
    """Track half way between two tracks."""
    return Track((before.positions + after.positions) / 2, after.rotations)
