"""One foot of a body that comes in live: what of it stands is told from the past alone (METHOD 4).

Heel or ball begin to stand where they are low and slow, and no longer do where they are clearly higher or faster. They
stand where they were shown last; what is different at such a change dies away, so that nothing jumps.
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
from studio.core.kernels.support.swing_foot_clearance import SWING_FADE, raise_swing_foot
from studio.core.normalized.transition import pace_left, place_left
from studio.core.solver.standing.blends import GOES_ALONG
from studio.core.solver.standing.footprints import planes_under, soles_of, tilts_of
from studio.core.solver.standing.held_foot import FootPath
from studio.core.solver.standing.tipping import depths_of, out_of_ground

FloatArray = NDArray[np.float64]

LIFTED, HURRYING = 1.5 * HEIGHT_MARGIN, 1.6 * STILL_SPEED
"""Metres above the floor, and metres a second, beyond which what stands no longer does."""
USUAL_LEG = 0.85
"""Metres: bodies with other legs stand by heights and speeds as many times as large."""
COMING_DOWN = 0.12
"""Seconds in which a foot that begins to stand is brought down to the ground, and level."""
TORN = 0.15
"""Parts of the leg's length from where its sender has it at which a foot that stands lets go."""
CLIMBING = 0.1
"""Seconds in which a height follows another one."""
GROUND_LOOK_AHEAD = 0.15
"""Seconds ahead, as fast as it goes, for which a foot in the air is kept above the ground."""
STRAIGHT = 3.0
"""How many times faster than its gap at once a gap may close that is not to open again on the other side."""


class FootPose(NamedTuple):
    """A foot: its ankle (3,), and how it and its toes are turned (3, 3)."""

    ankle: FloatArray
    foot: FloatArray
    toe: FloatArray


@dataclass
class DampedHeight:
    """A height that follows another one, critically damped."""

    value: float
    speed: float = 0.0

    def follow(self, goal: float, dt: float) -> float:
        """``dt`` seconds later."""
        rate = 2.0 / CLIMBING
        gap, decay = self.value - goal, math.exp(-rate * dt)
        push = self.speed + rate * gap
        self.value, self.speed = goal + (gap + push * dt) * decay, (self.speed - rate * push * dt) * decay
        return self.value


@dataclass(frozen=True, eq=False)
class _Print:
    """Where a foot stands: on its heel or its ball, at a ``place`` (3,); ``tilt`` (3, 3) of the ground there."""

    pivot: int
    place: FloatArray
    tilt: FloatArray


@dataclass
class Foothold:
    """One foot on one body and ground, from frame to frame: ``step`` it, and say where it was ``shown``."""

    body: Morphology
    side: int
    ground: Ground
    climb: DampedHeight
    """The height of the ground under it, smoothed."""
    state: int = 0
    """What stands, in bits as ``kernels.support.sole`` has them."""
    weight: float = 0.0
    """How far it stands: eased to 1 after it begins to, and back."""
    _printed: _Print | None = None
    _heading: FloatArray = field(default_factory=lambda: np.array([1.0, 0.0]))
    _own: list[FootPose] = field(default_factory=list)
    _shown: list[FootPose] = field(default_factory=list)
    _gaps: FloatArray = field(default_factory=lambda: np.zeros((2, 3, 3)))
    """What was different in the two frames before the last change: place, turn of foot and of toes."""
    _pace: float = math.inf
    """Seconds between these two."""
    _since: float = math.inf
    """Seconds since then."""

    def step(self, own: FootPose, low: float, dt: float) -> FootPose:
        """Where the foot is to be, ``dt`` seconds later, that came in as its ``own``.

        Heights that tell what stands are above ``low``.
        """
        self._climb(own, dt)
        self._since += dt
        state = self._found(own, low, dt)
        if state != self.state:
            self._change(state, own, dt)
        grows = dt / SWING_FADE if self._shown else 1.0
        self.weight = min(max(self.weight + (grows if state else -grows), 0.0), 1.0)
        self._own = [*self._own[-1:], own]
        aimed = self._led(self._aimed(own))
        return self._out_of_ground(aimed) if state else self._above_ground(aimed)

    def show(self, shown: FootPose) -> None:
        """What became of it: legs reach no farther than they do."""
        self._shown = [*self._shown[-1:], shown]

    def _climb(self, own: FootPose, dt: float) -> None:
        points = self.points_of(own)
        if self.ground.is_level or not self._own:
            self.climb.value = float(self.ground.height_at(points).max())
        elif self._printed is not None:
            self.climb.follow(float(self.ground.height_at(self._printed.place)), dt)
        else:
            way = GROUND_LOOK_AHEAD * (own.ankle - self._own[-1].ankle) / max(dt, 1e-3)
            self.climb.follow(float(self.ground.height_at([*points, *(points + way)]).max()), dt)

    def _found(self, own: FootPose, low: float, dt: float) -> int:
        """What stands."""
        if self._printed is not None and self._is_torn(own):
            return 0
        size, points, speeds = self.body.leg_length / USUAL_LEG, self.points_of(own), np.zeros(2)
        if self._own and dt > 0.0:
            speeds = np.linalg.norm(points - self.points_of(self._own[-1]), axis=1) / (size * dt)
        state = 0
        for bit, height, speed in zip((HEEL_STANDS, TOE_STANDS), (points[:, 2] - low) / size, speeds, strict=True):
            highest, fastest = (LIFTED, HURRYING) if self.state & bit else (HEIGHT_MARGIN, STILL_SPEED)
            state |= bit if height < highest and speed < fastest else 0
        return state

    def _is_torn(self, own: FootPose) -> bool:
        return float(np.linalg.norm((own.ankle - self._shown[-1].ankle)[:2])) > TORN * self.body.leg_length

    def _change(self, state: int, own: FootPose, dt: float) -> None:
        """Another state begins: what is different between it and the last two frames shown will die away."""
        seen, held = self._shown[-1] if self._shown else own, self._printed
        if state == SOLE_STANDS:
            self._heading = seen.foot[:2, 0]
        self.state = state
        if not state:
            self._printed = None
        elif held is None or not held.pivot & state:
            self._printed = self._print(HEEL_STANDS if state & HEEL_STANDS else TOE_STANDS, seen, held)
        if len(self._shown) < 2:
            return
        self._gaps = np.array([self._gap(*pair) for pair in zip(self._shown, map(self._aimed, self._own), strict=True)])
        if self._printed is not None:
            self._gaps[:, 0, :2] = 0.0  # it stands still from now on
        self._pace, self._since = max(dt, 1e-3), dt

    def _print(self, pivot: int, seen: FootPose, held: _Print | None) -> _Print:
        """Where heel or ball come to stand: below where they are seen, on the plane that the foot is on already."""
        place = seen.ankle + seen.foot @ self._lever(pivot)
        if held is None:
            soles = soles_of(seen.ankle[None], seen.foot[None], sole_rows(self.body, self.side))
            planes = planes_under(self.ground, soles)
            tilt = Rotation.from_rotvec(tilts_of(planes.normals)[0]).as_matrix()
            at, height = np.array([*soles[0, 1], planes.heights[0]]), 0.0
        else:
            tilt, at, height = held.tilt, held.place, self._thickness(held.pivot)
        normal = tilt[:, 2]
        level = at[2] - normal[:2] @ (place[:2] - at[:2]) / normal[2]
        return _Print(pivot, np.array([*place[:2], level + (self._thickness(pivot) - height) / normal[2]]), tilt)

    def _aimed(self, own: FootPose) -> FootPose:
        """Where the foot is to be by its state alone."""
        printed = self._printed
        if printed is None:
            return own._replace(ankle=own.ankle + np.array([0.0, 0.0, self.climb.value]))
        turn = printed.tilt @ (_level(self._heading) if self.state == SOLE_STANDS else own.foot)
        toe = printed.tilt @ _level(turn[:2, 0]) if self.state & TOE_STANDS else turn @ own.foot.T @ own.toe
        return FootPose(printed.place - turn @ self._lever(printed.pivot), turn, toe)

    def _above_ground(self, pose: FootPose) -> FootPose:
        """A foot in the air raised, and its toes bent up, where it would be in the ground."""
        ankles, feet, toes = (np.stack([each] * 2) for each in pose)
        height = float(self.ground.height_at(self.points_of(pose)).max())
        raise_swing_foot(sole_rows(self.body, self.side), np.zeros(2, np.int64), height, 1.0, ankles, feet, toes)
        return FootPose(ankles[0], feet[0], toes[0])

    def _out_of_ground(self, pose: FootPose) -> FootPose:
        feet, measures = FootPath(*(each[None] for each in pose)), sole_rows(self.body, self.side)
        freed = out_of_ground(feet, measures, depths_of(feet, measures, self.ground))
        return FootPose(freed.ankles[0], freed.feet[0], freed.toes[0])

    def _gap(self, shown: FootPose, aimed: FootPose) -> FloatArray:
        """(3, 3) from a foot as it is aimed to what was shown: what it turns about, and the turns of foot and toes."""
        place = shown.ankle + (shown.foot - aimed.foot) @ self._pivot - aimed.ankle
        turns = [Rotation.from_matrix(a @ b.T).as_rotvec() for a, b in zip(shown[1:], aimed[1:], strict=True)]
        return np.array([place, *turns])

    def _led(self, aimed: FootPose) -> FootPose:
        """A foot as it is aimed, with what is left of the gap at the last change."""
        way, foot, toe = (self._left(*gaps) for gaps in np.swapaxes(self._gaps, 0, 1))
        turned, bent = (
            Rotation.from_rotvec(foot).as_matrix() @ aimed.foot,
            Rotation.from_rotvec(toe).as_matrix() @ aimed.toe,
        )
        return FootPose(aimed.ankle + way + (aimed.foot - turned) @ self._pivot, turned, bent)

    def _left(self, before: FloatArray, last: FloatArray) -> FloatArray:
        """What is left of a gap; what comes to stand does not go past where it stands."""
        seconds, speed, size = GOES_ALONG, (last - before) / self._pace, float(np.linalg.norm(last))
        if self.state:
            closing = -float(speed @ last) / max(size, 1e-9)
            seconds = min(COMING_DOWN, STRAIGHT * size / max(closing, 1e-9)) if closing > 0.0 else COMING_DOWN
            speed = -closing * last / max(size, 1e-9) if closing > 0.0 else 0.0 * speed
        times = np.array(self._since)
        return np.asarray(place_left(times, max(seconds, 1e-3)) * last + pace_left(times, max(seconds, 1e-3)) * speed)

    @property
    def _pivot(self) -> FloatArray:
        return self._lever(self._printed.pivot if self._printed else TOE_STANDS)

    def _lever(self, pivot: int) -> FloatArray:
        """(3,) from the ankle to heel or ball, in the foot's axes."""
        return self._heel if pivot == HEEL_STANDS else np.asarray(self.body.foot[self.side])

    @property
    def _heel(self) -> FloatArray:
        return np.array([-self.body.heel_length[self.side], 0.0, -self.body.ankle_height[self.side]])

    def _thickness(self, pivot: int) -> float:
        """Metres from the ground to a pivot: heels are on it, the joint of the toes is not."""
        return 0.0 if pivot == HEEL_STANDS else float(self.body.ankle_height[self.side] + self.body.foot[self.side, 2])

    def points_of(self, pose: FootPose) -> FloatArray:
        """(2, 3) the soles of heel and ball."""
        ball = pose.ankle + pose.foot @ self._lever(TOE_STANDS)
        return np.array([pose.ankle + pose.foot @ self._heel, ball - [0.0, 0.0, self._thickness(TOE_STANDS)]])


def _level(heading: FloatArray) -> FloatArray:
    """(3, 3) level, with its x axis along ``heading`` (2,)."""
    x, y = heading / max(float(np.linalg.norm(heading)), 1e-9)
    return np.array([[x, -y, 0.0], [y, x, 0.0], [0.0, 0.0, 1.0]])
