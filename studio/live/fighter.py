"""A fighter that keeps at striking distance of a target that moves, and strikes when it is told to (P09 section 4).

A finite state machine over rows of clips: it stands on guard, steps where the target has gone, and strikes. What it
plays next is made beside the animation; until it is there, what plays goes on. Every frame is solved when it is shown,
with the target where it is then.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.kernels import layout as at
from studio.core.normalized.compose import compose
from studio.core.normalized.encode import encode
from studio.core.normalized.joining import Planar
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import Piece
from studio.core.solver.adapt import hold
from studio.core.solver.standing.stand import Standing, stand
from studio.library.clips import Kind, Limb
from studio.library.hitting import hit_places, limb_root
from studio.library.library import Library
from studio.library.searching import Asked, find
from studio.library.striking import Blow, make_strike
from studio.live.keeping import STEP_SECONDS

FloatArray = NDArray[np.float64]

HELD = 2.0
"""Seconds for which what was shown last is held before what is played next: feet that stand go on standing there."""
SEEN = 3
"""Frames that were shown last, from which what comes next takes its speed over."""
LONGEST_STEP, WIDEST_TURN = 0.4, 0.7
"""Leg lengths and radians of one step."""
NEAR_ENOUGH, TURNED_ENOUGH = 0.12, 0.25
"""Leg lengths and radians by which it may stand otherwise than it wants to."""


class State(StrEnum):
    """What a fighter does."""

    GUARD = "guard"
    STEP = "step"
    STRIKE = "strike"


@dataclass(frozen=True, eq=False)
class Plan:
    """What is played: a motion standing on the ground, from frame ``first`` on, and what makes it hit."""

    state: State
    standing: Standing
    first: int
    constraint: PositionConstraint | None = None
    blow: Blow | None = None
    hit: int = -1

    @property
    def last(self) -> int:
        return self.standing.motion.frame_count - 1


@dataclass(frozen=True)
class Hit:
    """What became of a strike: seconds of the fight, limb, metres by which it missed, metres of bending it took.

    ``apart`` is how far the target was from shoulder or hip, in lengths of the arm or leg without hand or foot.
    """

    seconds: float
    limb: Limb
    kind: Kind
    missed: float
    found_reach: float
    apart: float


@dataclass
class Fighter:
    """``step`` it once a frame; ``strike`` asks for a blow. ``guard`` is what it plays between, its feet in place.

    ``distance`` is how far from the target its root keeps, in leg lengths. With an ``executor`` plans are made beside
    the animation, without one at once. ``follows`` says whether a blow goes for where the target is, or was.
    """

    library: Library
    body: Morphology
    guard: Piece
    distance: float = 1.05
    executor: Executor | None = None
    follows: bool = True
    frame: int = 0
    frames_played: int = 0
    hits: list[Hit] = field(default_factory=list)
    _wanted: Future[Plan] | None = None
    _reach: float = 0.0
    _shown: deque[tuple[FloatArray, FloatArray]] = field(default_factory=lambda: deque(maxlen=SEEN))

    def __post_init__(self) -> None:
        whole = compose((replace(self.guard, start=0.0),))
        span = self.guard.first, self.guard.last
        cut = NormalizedMotion("guard", whole.motion.frame_rate, whole.motion.channels[span[0] : span[1] + 1].copy(),
                               whole.motion.spine_places)  # fmt: skip
        self.plan = self._plan(State.GUARD, cut, _cut(whole.contacts, *span), 0)

    @property
    def rate(self) -> float:
        """Frames a second."""
        return self.plan.standing.motion.frame_rate

    def change_body(self, body: Morphology) -> None:
        """Another character goes on with what plays."""
        old, leg = self.plan.standing, self.body.leg_length
        self.body = body
        channels = np.array(old.motion.channels)
        channels[:, at.HIPS : at.HIPS + 2] *= leg / body.leg_length  # it stays where it is on the ground
        standing = stand(replace(old.motion, channels=channels), body, old.contacts, Ground())
        self.plan = replace(self.plan, standing=standing)
        self._shown.clear()

    def strike(self, target: ArrayLike, limbs: Sequence[Limb] = (), kinds: Sequence[Kind] = ()) -> bool:
        """Strike at ``target`` (3,) as soon as a plan for it is made; False while another blow is under way."""
        if self._wanted is not None or self.plan.state is State.STRIKE:
            return False
        place, played = np.array(target, dtype=np.float64), self._played()
        self._make(lambda: self._strike(played, place, limbs, kinds))
        return True

    def step(self, target: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """The next frame, positions (K+23, 3) and rotations (K+18, 3, 3), with the target where it is now."""
        place = np.asarray(target, dtype=np.float64)
        self._take_plan()
        if self.frame >= self.plan.last or (self.plan.state is State.GUARD and self._stands_wrong(place)):
            self._next(place)
        plan = self.plan
        asked = [] if plan.constraint is None else [self._aimed(plan.constraint, place)]
        posed = hold(plan.standing, asked, self.frame, self.frame)
        if self.frame == plan.hit and plan.blow is not None:
            self._note_hit(plan.blow, posed.positions[:], posed.rotations[:], np.array(asked[0].target))
        self.frame = min(self.frame + 1, plan.last)
        self.frames_played += 1
        self._shown.append((posed.positions[0], posed.rotations[0]))
        return posed.positions[0], posed.rotations[0]

    # Plans

    def _make(self, work: Callable[[], Plan]) -> None:
        if self.executor is not None:
            self._wanted = self.executor.submit(work)
            return
        made: Future[Plan] = Future()
        made.set_result(work())
        self._wanted = made

    def _take_plan(self) -> None:
        """Go over to what was asked for once it is there; meanwhile what plays went on."""
        if self._wanted is None or not self._wanted.done():
            return
        made, self._wanted = self._wanted.result(), None
        self.plan, self.frame = made, made.first

    def _next(self, place: FloatArray) -> None:
        turn, offset = self._correction(place)
        wrong = abs(turn) > TURNED_ENOUGH or float(np.hypot(*offset)) > NEAR_ENOUGH
        self.plan = self._stepping(turn, offset) if wrong else self._guarding()
        self.frame = self.plan.first

    def _guarding(self) -> Plan:
        played = self._played()
        start, change = self._after(played)
        whole = compose((played, replace(self.guard, start=start, ease=0.4)))
        return self._plan(State.GUARD, whole.motion, whole.contacts, change)

    def _stepping(self, turn: float, offset: FloatArray) -> Plan:
        own = Planar(turn, (float(offset[0]), float(offset[1])))
        played = self._played()
        start, change = self._after(played)
        whole = compose((played, replace(self.guard, start=start, own=own, ease=STEP_SECONDS)))
        return self._plan(State.STEP, whole.motion, whole.contacts, change)

    def _strike(self, played: Piece, place: FloatArray, limbs: Sequence[Limb], kinds: Sequence[Kind]) -> Plan:
        motion = played.motion
        pose = replace(motion, channels=motion.channels[-1:])
        best = find(self.library, Asked(pose, self.body, place, limbs, kinds), 1)
        if not best:
            return self._guarding()
        blow = Blow.of(best[0])
        x, y, z = place.tolist()
        made = make_strike(played, played.last, blow, self.body, (x, y, z))
        standing = stand(made.composite.motion, self.body, made.composite.contacts, Ground())
        self._reach = best[0].reach
        return Plan(State.STRIKE, standing, made.change, made.constraint, blow, made.hit)

    def _plan(self, state: State, motion: NormalizedMotion, contacts: tuple[ContactInterval, ...], first: int) -> Plan:
        return Plan(state, stand(motion, self.body, contacts, Ground()), first)

    def _played(self) -> Piece:
        """What was shown last as a motion, held before: what comes next begins where the body is seen to be."""
        shown = list(self._shown) or [(each[0], each[1]) for each in [self._posed()]]
        held = [shown[-1]] * round(HELD * self.rate)
        positions, rotations = (np.stack(each) for each in zip(*held, *shown, strict=True))
        motion = encode(positions, rotations, self.body, self.rate, "shown")
        last, now = motion.frame_count - 1, max(self.frame - 1, 0)
        standing = [each for each in self.plan.standing.contacts if each.first <= now <= each.last]
        return Piece(motion, tuple(replace(each, first=0, last=last) for each in standing), 0, last)

    def _posed(self) -> tuple[FloatArray, FloatArray]:
        return self.plan.standing.positions[self.frame], self.plan.standing.rotations[self.frame]

    def _after(self, played: Piece) -> tuple[float, int]:
        """When, and in which frame, what comes behind ``played`` begins."""
        return (played.last + 1) / self.rate, played.last + 1

    # Where it stands

    def _correction(self, place: FloatArray) -> tuple[float, FloatArray]:
        """The turn (rad) and the way over the ground (2,), in leg lengths, of its next step."""
        leg = self.body.leg_length
        channels = self.plan.standing.motion.channels[self.frame]
        root = channels[at.HIPS : at.HIPS + 2]
        away = place[:2] / leg - root
        apart = float(np.linalg.norm(away))
        forward = away / max(apart, 1e-9)
        facing = math.atan2(forward[1], forward[0]) + self._stance()
        turn = (facing - float(channels[at.YAW]) + math.pi) % (2.0 * math.pi) - math.pi
        way = float(np.clip(apart - self.distance, -LONGEST_STEP, LONGEST_STEP))
        return float(np.clip(turn, -WIDEST_TURN, WIDEST_TURN)), way * forward

    def _stance(self) -> float:
        """How the pelvis on guard is turned against where it looks: half sideways, as fighters stand."""
        return float(np.median(self.guard.motion.channels[self.guard.first : self.guard.last + 1, at.YAW]))

    def _stands_wrong(self, place: FloatArray) -> bool:
        if self._wanted is not None or self.frame < self.plan.first + round(0.4 * self.rate):
            return False
        turn, offset = self._correction(place)
        return abs(turn) > TURNED_ENOUGH or float(np.hypot(*offset)) > NEAR_ENOUGH

    # Blows

    def _aimed(self, constraint: PositionConstraint, place: FloatArray) -> PositionConstraint:
        if not self.follows or self.frame > self.plan.hit:
            return constraint
        x, y, z = place.tolist()
        aimed = replace(constraint, target=(x, y, z))
        self.plan = replace(self.plan, constraint=aimed)
        return aimed

    def _note_hit(self, blow: Blow, positions: FloatArray, rotations: FloatArray, target: FloatArray) -> None:
        label = blow.label
        where = hit_places(positions, rotations, self.body, label.limb, label.segment)[0]
        missed = float(np.linalg.norm(where - target))
        bones = (self.body.arm if label.limb.is_arm else self.body.leg)[label.limb.side]
        away = positions[0, limb_root(self.body.layout, label.limb)] - target
        apart = float(np.linalg.norm(away) / bones.sum())
        self.hits.append(Hit(self.frames_played / self.rate, label.limb, label.kind, missed, self._reach, apart))


def _cut(contacts: Sequence[ContactInterval], first: int, last: int) -> tuple[ContactInterval, ...]:
    """Contacts of frames ``first`` to ``last``, counted from there."""
    return tuple(
        replace(each, first=max(each.first, first) - first, last=min(each.last, last) - first)
        for each in contacts
        if each.last >= first and each.first <= last
    )
