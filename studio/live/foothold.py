"""Contacts of one foot of a live body, decided from past frames alone (METHOD 6).

A contact of heel or ball begins when it is low and slow, and ends when it is clearly higher or faster. Its position is
where the foot was last shown; the difference at such a change decays, so that nothing jumps.
"""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.morphology import Morphology, sole_rows
from studio.core.captures.contacts import HEIGHT_MARGIN, STILL_SPEED
from studio.core.grounds.ground import Ground
from studio.core.kernels.support.sole import HEEL_STANDS, SOLE_STANDS, TOE_STANDS
from studio.core.kernels.support.swing_foot_clearance import SWING_FADE_SECONDS, raise_swing_foot
from studio.core.normalized.transition import remaining_offset_fraction, remaining_speed_offset
from studio.core.solver.grounding.contact_blending import DISPLACEMENT_RETURN_SECONDS
from studio.core.solver.grounding.foot_tipping import depths_of, raised_out_of_ground
from studio.core.solver.grounding.footprints import planes_under, soles_of, tilts_of
from studio.core.solver.grounding.held_foot import FootPath, Pivot, heel_pivot, sole_arms, toe_pivot

FloatArray = NDArray[np.float64]

RELEASE_HEIGHT_METRES, RELEASE_SPEED = 1.5 * HEIGHT_MARGIN, 1.6 * STILL_SPEED
"""Height above the floor in metres, and speed in metres per second, above which a standing heel or ball is released."""
USUAL_LEG_METRES = 0.85
"""Reference leg length in metres; the thresholds of height and speed scale with the leg length of the body."""
LOWERING_SECONDS = 0.12
"""Seconds in which a foot that begins to stand is lowered to the ground and levelled."""
RELEASE_DISTANCE_LEGS = 0.15
"""Horizontal distance in leg lengths between received and displayed ankle at which a standing foot is released."""
GROUND_SMOOTHING_SECONDS = 0.1
"""Smoothing time in seconds of the height of the ground."""
LOOK_AHEAD_SECONDS = 0.15
"""Seconds of look-ahead, at the current velocity, for which a foot in the air is kept above the ground."""
STRAIGHT_DECAY_FACTOR = 3.0
"""Longest decay of a gap without overshoot, as a multiple of its size divided by its closing speed."""


class FootPose(NamedTuple):
    """Pose of a foot: position of the ankle (3,) in metres, and rotations (3, 3) of the foot and of its toes."""

    ankle: FloatArray
    foot: FloatArray
    toe: FloatArray


@dataclass
class DampedHeight:
    """Critically damped height that follows a goal."""

    value: float
    speed: float = 0.0

    def follow(self, goal: float, dt: float) -> float:
        """Advance by ``dt`` seconds towards ``goal`` and return the height."""
        rate = 2.0 / GROUND_SMOOTHING_SECONDS
        gap, decay = self.value - goal, math.exp(-rate * dt)
        push = self.speed + rate * gap
        self.value, self.speed = goal + (gap + push * dt) * decay, (self.speed - rate * push * dt) * decay
        return self.value


@dataclass(frozen=True, eq=False)
class _Footprint:
    """Footprint of a heel or of toes (``state``, a bit): the ``pivot`` in contact, its position ``place`` (3,), and the
    ``tilt`` (3, 3) of the ground there.
    """

    state: int
    pivot: Pivot
    place: FloatArray
    tilt: FloatArray


@dataclass
class Foothold:
    """One foot on one body and ground, from frame to frame: call ``step``, then ``update`` with the pose that was
    reached.
    """

    body: Morphology
    side: int
    ground: Ground
    climb: DampedHeight
    """Smoothed height of the ground under the foot."""
    state: int = 0
    """Parts of the foot that stand, as bits of ``kernels.support.sole``."""
    weight: float = 0.0
    """Contact weight: rises to 1 after the foot begins to stand, and falls to 0 after it stops."""
    _printed: _Footprint | None = None
    _heading: FloatArray = field(default_factory=lambda: np.array([1.0, 0.0]))
    _own: list[FootPose] = field(default_factory=list)
    _shown: list[FootPose] = field(default_factory=list)
    _gaps: FloatArray = field(default_factory=lambda: np.zeros((2, 3, 3)))
    """Differences (2, 3, 3) between the shown and the aimed foot, in the two frames before the last change:
    displacement (m), and rotation vectors of foot and toes.
    """
    _pace: float = math.inf
    """Seconds between these two frames."""
    _since: float = math.inf
    """Seconds since the last change."""

    def step(self, own: FootPose, low: float, dt: float) -> FootPose:
        """Target pose of the foot ``dt`` seconds later, from the received pose ``own``.

        Heights that decide contacts are measured above ``low`` (m).
        """
        self._climb(own, dt)
        self._since += dt
        state = self._found(own, low, dt)
        if state != self.state:
            self._change(state, own, dt)
        grows = dt / SWING_FADE_SECONDS if self._shown else 1.0
        self.weight = min(max(self.weight + (grows if state else -grows), 0.0), 1.0)
        self._own = [*self._own[-1:], own]
        aimed = self._led(self._aimed(own))
        return self._out_of_ground(aimed) if state else self._above_ground(aimed)

    def update(self, shown: FootPose) -> None:
        """Store the pose that was reached: a leg may be too short for the target pose."""
        self._shown = [*self._shown[-1:], shown]

    def _climb(self, own: FootPose, dt: float) -> None:
        points = self.points_of(own)
        if self.ground.is_level or not self._own:
            self.climb.value = float(self.ground.height_at(points).max())
        elif self._printed is not None:
            self.climb.follow(float(self.ground.height_at(self._printed.place)), dt)
        else:
            way = LOOK_AHEAD_SECONDS * (own.ankle - self._own[-1].ankle) / max(dt, 1e-3)
            self.climb.follow(float(self.ground.height_at([*points, *(points + way)]).max()), dt)

    def _found(self, own: FootPose, low: float, dt: float) -> int:
        """Parts of the foot in contact, as bits."""
        if self._printed is not None and self._is_torn(own):
            return 0
        size, points, speeds = self.body.leg_length / USUAL_LEG_METRES, self.points_of(own), np.zeros(2)
        if self._own and dt > 0.0:
            speeds = np.linalg.norm(points - self.points_of(self._own[-1]), axis=1) / (size * dt)
        state = 0
        for bit, height, speed in zip((HEEL_STANDS, TOE_STANDS), (points[:, 2] - low) / size, speeds, strict=True):
            highest, fastest = (
                (RELEASE_HEIGHT_METRES, RELEASE_SPEED) if self.state & bit else (HEIGHT_MARGIN, STILL_SPEED)
            )
            state |= bit if height < highest and speed < fastest else 0
        return state

    def _is_torn(self, own: FootPose) -> bool:
        return (
            float(np.linalg.norm((own.ankle - self._shown[-1].ankle)[:2]))
            > RELEASE_DISTANCE_LEGS * self.body.leg_length
        )

    def _change(self, state: int, own: FootPose, dt: float) -> None:
        """Change the contact state; its difference from the last two frames shown will decay."""
        seen, held = self._shown[-1] if self._shown else own, self._printed
        if state == SOLE_STANDS:
            self._heading = seen.foot[:2, 0]
        self.state = state
        if not state:
            self._printed = None
        elif held is None or not held.state & state:
            self._printed = self._print(HEEL_STANDS if state & HEEL_STANDS else TOE_STANDS, seen, held)
        if len(self._shown) < 2:
            return
        self._gaps = np.array([self._gap(*pair) for pair in zip(self._shown, map(self._aimed, self._own), strict=True)])
        if self._printed is not None:
            self._gaps[:, 0, :2] = 0.0  # it stands still from now on
        self._pace, self._since = max(dt, 1e-3), dt

    def _print(self, state: int, seen: FootPose, held: _Footprint | None) -> _Footprint:
        """Footprint of heel or toes: below their shown position, on the plane of the footprint ``held``, otherwise of
        the ground.
        """
        measures = sole_rows(self.body, self.side)
        pivot = heel_pivot(measures) if state == HEEL_STANDS else toe_pivot(measures, seen.toe)
        place = seen.ankle + pivot.offsets(seen.foot, seen.toe)
        lowest = seen.ankle + pivot._replace(ahead=0.0).offsets(seen.foot, seen.toe)
        if held is None:
            soles = soles_of(seen.ankle[None], seen.foot[None], sole_rows(self.body, self.side))
            planes = planes_under(self.ground, soles)
            tilt = Rotation.from_rotvec(tilts_of(planes.normals)[0]).as_matrix()
            at = np.array([*soles[0, 1], planes.heights[0]])
        else:
            tilt, at = held.tilt, held.place
        normal = tilt[:, 2]
        level = at[2] - normal[:2] @ (lowest[:2] - at[:2]) / normal[2]
        return _Footprint(state, pivot, np.array([*place[:2], level]), tilt)

    def _aimed(self, own: FootPose) -> FootPose:
        """Target pose of the foot by its contact state alone, without the remaining gap."""
        printed = self._printed
        if printed is None:
            return own._replace(ankle=own.ankle + np.array([0.0, 0.0, self.climb.value]))
        turn = printed.tilt @ (_level(self._heading) if self.state == SOLE_STANDS else own.foot)
        toe = printed.tilt @ _level(turn[:2, 0]) if self.state & TOE_STANDS else turn @ own.foot.T @ own.toe
        return FootPose(printed.place - self._pivot.offsets(turn, toe), turn, toe)

    def _above_ground(self, pose: FootPose) -> FootPose:
        """Pose of a foot in the air, raised and with its toes bent up where it would penetrate the ground."""
        ankles, feet, toes = (np.stack([each] * 2) for each in pose)
        height = float(self.ground.height_at(self.points_of(pose)).max())
        raise_swing_foot(sole_rows(self.body, self.side), np.zeros(2, np.int64), height, 1.0, ankles, feet, toes)
        return FootPose(ankles[0], feet[0], toes[0])

    def _out_of_ground(self, pose: FootPose) -> FootPose:
        feet, measures = FootPath(*(each[None] for each in pose)), sole_rows(self.body, self.side)
        freed = raised_out_of_ground(feet, measures, depths_of(feet, measures, self.ground))
        return FootPose(freed.ankles[0], freed.feet[0], freed.toes[0])

    def _gap(self, shown: FootPose, aimed: FootPose) -> FloatArray:
        """Difference (3, 3) from the ``aimed`` to the ``shown`` foot: displacement of the pivot (m), rotation vectors
        of foot and toes.
        """
        place = shown.ankle + self._pivot.offsets(*shown[1:]) - aimed.ankle - self._pivot.offsets(*aimed[1:])
        turns = [Rotation.from_matrix(a @ b.T).as_rotvec() for a, b in zip(shown[1:], aimed[1:], strict=True)]
        return np.array([place, *turns])

    def _led(self, aimed: FootPose) -> FootPose:
        """Target pose with the rest of the gap at the last change added to it."""
        way, foot, toe = (self._left(*gaps) for gaps in np.swapaxes(self._gaps, 0, 1))
        turned, bent = (
            Rotation.from_rotvec(foot).as_matrix() @ aimed.foot,
            Rotation.from_rotvec(toe).as_matrix() @ aimed.toe,
        )
        place = aimed.ankle + self._pivot.offsets(*aimed[1:]) + way
        return FootPose(place - self._pivot.offsets(turned, bent), turned, bent)

    def _left(self, before: FloatArray, last: FloatArray) -> FloatArray:
        """Rest of a gap (3,) at this time; while the foot stands it closes without overshoot."""
        seconds, speed, size = DISPLACEMENT_RETURN_SECONDS, (last - before) / self._pace, float(np.linalg.norm(last))
        if self.state:
            closing = -float(speed @ last) / max(size, 1e-9)
            seconds = (
                min(LOWERING_SECONDS, STRAIGHT_DECAY_FACTOR * size / max(closing, 1e-9))
                if closing > 0.0
                else LOWERING_SECONDS
            )
            speed = -closing * last / max(size, 1e-9) if closing > 0.0 else 0.0 * speed
        times = np.array(self._since)
        return np.asarray(
            remaining_offset_fraction(times, max(seconds, 1e-3)) * last
            + remaining_speed_offset(times, max(seconds, 1e-3)) * speed
        )

    @property
    def _pivot(self) -> Pivot:
        return self._printed.pivot if self._printed else toe_pivot(sole_rows(self.body, self.side), np.eye(3))

    def points_of(self, pose: FootPose) -> FloatArray:
        """Points (2, 3) of the sole below heel and ball, in metres."""
        heel, joint, thickness, _ = (arm[0] for arm in sole_arms(sole_rows(self.body, self.side)))
        return np.array([pose.ankle + pose.foot @ heel, pose.ankle + pose.foot @ joint - thickness])


def _level(heading: FloatArray) -> FloatArray:
    """Rotation (3, 3) about the vertical whose x axis lies along ``heading`` (2,)."""
    x, y = heading / max(float(np.linalg.norm(heading)), 1e-9)
    return np.array([[x, -y, 0.0], [y, x, 0.0], [0.0, 0.0, 1.0]])
