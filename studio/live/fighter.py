"""Fighter that keeps its striking distance from a moving target, and strikes on order (P09 section 4).

A finite state machine over sequences of clips: it stands on guard, steps after the target, and strikes. The next motion
is made in the background while the current one plays on. Each frame is solved when it is shown, with the position of
the target at that time.
"""

import math
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.encode import encode_motion
from studio.core.normalized.joining import PlanarTransform
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import MotionPiece
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.library.clip_labels import Kind, Limb
from studio.library.hit_paths import hit_point_positions, limb_root
from studio.library.library import Library
from studio.library.searching import Result, StrikeQuery, search_strikes
from studio.library.striking import Strike, StrikeClip, strike_from_change
from studio.live.distance_keeping import DISTANCE_STEP_SECONDS
from studio.live.takeover import SPEED_FRAMES, Takeover, take_over

FloatArray = NDArray[np.float64]

FIGHTER_STEP, FIGHTER_TURN = 0.4, 0.7
"""Maximum displacement (leg lengths) and rotation (radians) of one step."""
FIGHTER_DISTANCE_TOLERANCE, FIGHTER_FACING_TOLERANCE = 0.12, 0.25
"""Errors of distance (leg lengths) and of facing (radians) that are accepted without a step."""
TARGET_SPEED_SECONDS = 0.2
"""Seconds of the target's recent path from which its velocity is estimated."""
USUAL_BLOW_SECONDS = 0.5
"""Assumed seconds to the hit during the search; each blow found is then tried with its own time."""
GUARD_BLEND_SECONDS = 0.4
"""Seconds of the blend into the guard; the stance is not corrected before they have passed."""
MAX_TRIED_STRIKES, HIT_TOLERANCE_METRES = 3, 0.001
"""Number of strikes tried for a target, best first, and the residual (m) below which one is accepted at once."""
MAX_STEPS_UP = 3
"""Maximum number of steps towards a target that no strike meets; after them the fighter strikes anyway."""


class FighterState(StrEnum):
    """Activity of a fighter."""

    GUARD = "guard"
    STEP = "step"
    STRIKE = "strike"


@dataclass(frozen=True, eq=False)
class Plan:
    """Grounded motion that is played from frame ``first`` on; for a strike also the blow, the constraint that makes it
    hit, and the frame ``hit``.
    """

    state: FighterState
    standing: GroundedMotion
    first: int
    blow: StrikeClip | None = None
    constraint: PositionConstraint | None = None
    hit: int = -1

    @property
    def last_frame(self) -> int:
        return self.standing.motion.frame_count - 1


@dataclass(frozen=True, eq=False)
class PendingPlan:
    """Plan in the making: a takeover that is not yet inertialised from the pose in which it begins."""

    state: FighterState
    takes: Takeover
    found: Result | None = None
    strike: Strike | None = None

    def plan(self, before: GroundedMotion, rows: NDArray[np.int64]) -> Plan:
        """Plan inertialised from the frames ``rows`` of ``before``."""
        standing, first = self.takes.inertialised(before, rows), self.takes.first
        if self.found is None or self.strike is None:
            return Plan(self.state, standing, first)
        return Plan(self.state, standing, first, StrikeClip.of(self.found), self.strike.constraint, self.strike.hit)

    @property
    def missed(self) -> float:
        """Residual of the hit in metres, before inertialisation; infinite without a strike."""
        if self.strike is None:
            return math.inf
        hit = self.strike.hit
        return float(solve_constraints(self.takes.standing, [self.strike.constraint], hit, hit).residuals[0, 0])


@dataclass(frozen=True, eq=False)
class PlanStart:
    """Start of a plan: the frames ``rows`` of ``previous_pose``, and the target's ``position`` (3,) and velocity
    ``speed`` (3,) (m/s).
    """

    previous_pose: GroundedMotion
    rows: NDArray[np.int64]
    position: FloatArray
    speed: FloatArray

    def position_in(self, seconds: float) -> FloatArray:
        """Predicted position (3,) of the target after ``seconds``."""
        return self.position + seconds * self.speed


@dataclass(frozen=True)
class StrikeOutcome:
    """Result of a strike: seconds of the fight, limb, kind, and residual ``missed`` in metres. ``found_reach`` is the
    distance in metres between hit and target before the clip was adapted.

    ``apart`` is the distance of the target from shoulder or hip, in lengths of the arm or leg without hand or foot.
    """

    seconds: float
    limb: Limb
    kind: Kind
    missed: float
    found_reach: float
    apart: float


@dataclass
class Fighter:
    """Fighter: call ``step`` once a frame, and ``strike`` to order a blow. ``guard`` plays between blows, its feet in
    place.

    ``distance`` is the distance that the root keeps from the target, in leg lengths. With an ``executor`` blows are
    made in the background, without one at once. If ``follows``, blows track the moving target; otherwise they go for
    the position that it had when they were made.
    """

    library: Library
    body: Morphology
    guard: MotionPiece
    distance: float = 1.05
    executor: Executor | None = None
    follows: bool = True
    frames_played: int = 0
    hits: list[StrikeOutcome] = field(default_factory=list)
    _wanted: Future[PendingPlan] | None = None
    _order: tuple[Sequence[Limb], Sequence[Kind]] | None = None
    """Limbs and kinds of an order that is not under way yet; None without an order."""
    _steps_left: int = 0
    _reach: float = 0.0
    _passed: int = 0
    """Number of frames shown of the current plan."""
    _places: deque[FloatArray] = field(default_factory=deque)
    """Recent positions (3,) of the target, the newest last."""

    def __post_init__(self) -> None:
        whole = compose_pieces((replace(self.guard, start=0.0),))
        span = self.guard.first, self.guard.last
        cut = NormalizedMotion("guard", whole.motion.frame_rate, whole.motion.channels[span[0] : span[1] + 1].copy(),
                               whole.motion.spine_places)  # fmt: skip
        self.plan = Plan(FighterState.GUARD, ground_motion(cut, self.body, _cut(whole.contacts, *span), Ground()), 0)
        self.rate = cut.frame_rate
        """Frames a second of ``step``, whatever the rate of the motion that plays."""
        self._places = deque(maxlen=1 + round(TARGET_SPEED_SECONDS * self.rate))

    @property
    def frame(self) -> int:
        """Frame of the plan that is shown next."""
        shown = round(self._passed * self.plan.standing.motion.frame_rate / self.rate)
        return min(self.plan.first + shown, self.plan.last_frame)

    @property
    def is_waiting(self) -> bool:
        """True while the plan for an order is being made."""
        return self._wanted is not None

    def change_body(self, body: Morphology) -> None:
        """Replace the character; the current motion goes on."""
        old, leg = self.plan.standing, self.body.leg_length
        self.body = body
        channels = np.array(old.motion.channels)
        channels[:, channel.HIPS : channel.HIPS + 2] *= (
            leg / body.leg_length
        )  # its position on the ground stays the same
        standing = ground_motion(replace(old.motion, channels=channels), body, old.contacts, Ground())
        self.plan = replace(self.plan, standing=standing)

    def strike(self, target: ArrayLike, limbs: Sequence[Limb] = (), kinds: Sequence[Kind] = ()) -> bool:
        """Order a strike at ``target`` (3,), begun as soon as its plan is made; False while another blow is under way.

        If no blow that was ordered meets the target, the fighter first steps towards it.
        """
        if self._order is not None or self.plan.state is FighterState.STRIKE:
            return False
        self._order, self._steps_left = (limbs, kinds), MAX_STEPS_UP
        self._ask(np.array(target, dtype=np.float64))
        return True

    def step(self, target: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Advance by one frame and return its positions (K+23, 3) and rotations (K+18, 3, 3), aimed at ``target``."""
        place = np.array(target, dtype=np.float64)
        self._places.append(place)
        if self._order is not None and self._wanted is None and self._played_for(DISTANCE_STEP_SECONDS):
            self._ask(place)
        self._take_plan()
        if self.frame >= self.plan.last_frame or (self.plan.state is FighterState.GUARD and self._stands_wrong(place)):
            self._go_on(self._next(place))
        plan, frame = self.plan, self.frame
        asked = [] if plan.constraint is None else [self._aimed(plan.constraint, place)]
        posed = solve_constraints(plan.standing, asked, frame, frame)
        self._passed += 1
        self.frames_played += 1
        if plan.blow is not None and frame <= plan.hit < self.frame:
            self._note_hit(plan.blow, posed.positions[:], posed.rotations[:], np.array(asked[0].target))
        return posed.positions[0], posed.rotations[0]

    # Plans

    def _ask(self, position: FloatArray) -> None:
        """Start making the plan for the order, in the background if there is an executor."""
        assert self._order is not None
        begins = PlanStart(self.plan.standing, self._rows, position, self._speed())
        order, step = (
            self._order,
            self._step_up(begins.position_in(DISTANCE_STEP_SECONDS)) if self._steps_left else None,
        )

        def work() -> PendingPlan:
            return self._strike(begins, *order, step)

        if self.executor is not None:
            self._wanted = self.executor.submit(work)
            return
        made: Future[PendingPlan] = Future()
        made.set_result(work())
        self._wanted = made

    def _take_plan(self) -> None:
        """Switch to the ordered plan if it is made; until then the current one plays on."""
        if self._wanted is None or not self._wanted.done():
            return
        made, self._wanted = self._wanted.result(), None
        if made.takes.standing.morphology is not self.body:  # the character was changed meanwhile
            self._ask(self._places[-1])
            return
        if made.state is FighterState.STEP:
            self._steps_left -= 1
        else:
            self._order = None
        if made.found is not None:
            self._reach = made.found.reach
        self._go_on(made)

    def _go_on(self, coming: PendingPlan) -> None:
        self.plan = coming.plan(self.plan.standing, self._rows)
        self._passed = 0

    def _next(self, position: FloatArray) -> PendingPlan:
        turn, offset = self._correction(position)
        wrong = abs(turn) > FIGHTER_FACING_TOLERANCE or float(np.hypot(*offset)) > FIGHTER_DISTANCE_TOLERANCE
        state, piece = (
            (FighterState.STEP, self._stepping(turn, offset)) if wrong else (FighterState.GUARD, self._guarding)
        )
        return self._coming(state, PlanStart(self.plan.standing, self._rows, position, np.zeros(3)), piece)

    @property
    def _guarding(self) -> MotionPiece:
        return replace(self.guard, start=0.0, ease=GUARD_BLEND_SECONDS)

    def _stepping(self, turn: float, offset: FloatArray) -> MotionPiece:
        own = PlanarTransform(turn, (float(offset[0]), float(offset[1])))
        return replace(self.guard, start=0.0, own=own, ease=DISTANCE_STEP_SECONDS)

    def _step_up(self, position: FloatArray) -> MotionPiece | None:
        """Step towards ``position``; None if it is not too far off."""
        turn, offset = self._correction(position)
        return (
            self._stepping(turn, offset) if self._apart(position) - self.distance > FIGHTER_DISTANCE_TOLERANCE else None
        )

    def _strike(
        self, begins: PlanStart, limbs: Sequence[Limb], kinds: Sequence[Kind], step: MotionPiece | None
    ) -> PendingPlan:
        """First of the best blows whose residual is below ``HIT_TOLERANCE_METRES``, otherwise the one with the least
        residual. If ``step`` is given and the best blow misses, the result is that step; if no blow is found, the
        guard.
        """
        before, last = begins.previous_pose, begins.rows[-1:]
        pose = encode_motion(before.positions[last], before.rotations[last], self.body, self.rate, "shown")
        found = search_strikes(
            self.library,
            StrikeQuery(pose, self.body, begins.position_in(USUAL_BLOW_SECONDS), limbs, kinds),
            MAX_TRIED_STRIKES if step is None else 1,
        )
        nearest, missed = None, math.inf
        for each in found:
            coming = self._blow(begins, each)
            if coming.missed < missed:
                nearest, missed = coming, coming.missed
            if missed < HIT_TOLERANCE_METRES:
                break
        if nearest is None:
            return self._coming(FighterState.GUARD, begins, self._guarding)
        return (
            nearest if step is None or missed < HIT_TOLERANCE_METRES else self._coming(FighterState.STEP, begins, step)
        )

    def _blow(self, begins: PlanStart, found: Result) -> PendingPlan:
        blow = StrikeClip.of(found)
        x, y, z = begins.position_in(blow.seconds).tolist()
        coming = self._coming(FighterState.STRIKE, begins, blow.piece(0.0))
        strike = strike_from_change(coming.takes.composite, coming.takes.first, blow, self.body, (x, y, z))
        return replace(coming, found=found, strike=strike)

    def _coming(self, state: FighterState, begins: PlanStart, piece: MotionPiece) -> PendingPlan:
        def stood(whole: Composite) -> GroundedMotion:
            return ground_motion(whole.motion, self.body, whole.contacts, Ground())

        return PendingPlan(state, take_over(begins.previous_pose, begins.rows, [piece], stood))

    @property
    def _rows(self) -> NDArray[np.int64]:
        """Frames (SPEED_FRAMES,) of the plan that were shown last."""
        every = self.plan.standing.motion.frame_rate / self.rate
        shown = self.plan.first + np.rint((self._passed - np.arange(SPEED_FRAMES, 0, -1)) * every).astype(np.int64)
        return np.asarray(shown.clip(max(self.plan.first - 1, 0), self.plan.last_frame))

    def _speed(self) -> FloatArray:
        """Velocity (3,) of the target in m/s, averaged over its recent positions; zero if blows do not follow it."""
        first, last = (self._places[0], self._places[-1]) if self.follows and self._places else (0.0, 0.0)
        return np.asarray(np.zeros(3) + (last - first) * self.rate / max(len(self._places) - 1, 1))

    def _played_for(self, seconds: float) -> bool:
        return self._passed >= round(seconds * self.rate)

    # Where it stands

    def _apart(self, position: FloatArray) -> float:
        """Horizontal distance from the root to ``position``, in leg lengths."""
        root = self.plan.standing.positions[self.frame, 0]
        return float(np.linalg.norm((position - root)[:2])) / self.body.leg_length

    def _correction(self, position: FloatArray) -> tuple[float, FloatArray]:
        """Rotation (rad) and horizontal displacement (2,), in leg lengths, of the next step, clamped to the maximum of
        one.
        """
        root = self.plan.standing.positions[self.frame, 0]
        away, apart = (position - root)[:2] / self.body.leg_length, self._apart(position)
        forward = away / max(apart, 1e-9)
        facing = math.atan2(forward[1], forward[0]) + self._stance()
        yaw = float(self.plan.standing.motion.channels[self.frame, channel.YAW])
        turn = (facing - yaw + math.pi) % (2.0 * math.pi) - math.pi
        way = float(np.clip(apart - self.distance, -FIGHTER_STEP, FIGHTER_STEP))
        return float(np.clip(turn, -FIGHTER_TURN, FIGHTER_TURN)), way * forward

    def _stance(self) -> float:
        """Median yaw (rad) of the pelvis on guard relative to the facing direction: fighters stand half sideways."""
        return float(np.median(self.guard.motion.channels[self.guard.first : self.guard.last + 1, channel.YAW]))

    def _stands_wrong(self, position: FloatArray) -> bool:
        if self._order is not None or not self._played_for(GUARD_BLEND_SECONDS):
            return False
        turn, offset = self._correction(position)
        return abs(turn) > FIGHTER_FACING_TOLERANCE or float(np.hypot(*offset)) > FIGHTER_DISTANCE_TOLERANCE

    # Blows

    def _aimed(self, constraint: PositionConstraint, position: FloatArray) -> PositionConstraint:
        if not self.follows or self.frame > self.plan.hit:
            return constraint
        x, y, z = position.tolist()
        aimed = replace(constraint, target=(x, y, z))
        self.plan = replace(self.plan, constraint=aimed)
        return aimed

    def _note_hit(self, blow: StrikeClip, positions: FloatArray, rotations: FloatArray, target: FloatArray) -> None:
        label = blow.label
        where = hit_point_positions(positions, rotations, self.body, label.limb, label.segment)[0]
        missed = float(np.linalg.norm(where - target))
        bones = (self.body.arm if label.limb.is_arm else self.body.leg)[label.limb.side]
        away = positions[0, limb_root(self.body.layout, label.limb)] - target
        apart = float(np.linalg.norm(away) / bones.sum())
        self.hits.append(
            StrikeOutcome(self.frames_played / self.rate, label.limb, label.kind, missed, self._reach, apart)
        )


def _cut(contacts: Sequence[ContactInterval], first: int, last: int) -> tuple[ContactInterval, ...]:
    """Contacts of frames ``first`` to ``last``, clipped to them and counted from ``first``."""
    return tuple(
        replace(each, first=max(each.first, first) - first, last=min(each.last, last) - first)
        for each in contacts
        if each.last >= first and each.first <= last
    )
