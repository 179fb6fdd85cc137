"""Transformation of a motion's constraints to where a clip of the motion plays: in time, in space, and mirrored."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain, Constraint, Vector
from studio.core.constraints.clear import Arms
from studio.core.constraints.follow import FOLLOWS, FollowBody, FollowPerformer, FollowProp
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.procedural import CirclePlace, NoisePlace, PendulumPlace
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, Keys, Quaternion
from studio.core.curves.retiming import Speed, motion_seconds, playing_seconds, speed_at
from studio.core.curves.tangents import Tangents
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.rotations import multiply

FloatArray = NDArray[np.float64]
KeysKind = TypeVar("KeysKind", bound=Keys)

BOUNDARY_FADE_SECONDS = 0.2
"""Seconds in which a constraint that is active at a clip's begin or end fades in or out."""
NEVER_ACTIVE = ActivationCurve(-10.0, -10.0, -10.0, -10.0)
"""Activation of a constraint that is never active: it lies before all motions."""
Y_MIRROR_SIGNS: Vector = (1.0, -1.0, 1.0)
"""Signs of the axes in the mirror image of a motion, which negates y."""
_HINGED = ("upper_arm", "forearm", "hand", "thigh", "shank")
"""Segments whose x axis is a hinge, which a mirror reverses."""
_SWAPPED = {Arms.LEFT: Arms.RIGHT, Arms.RIGHT: Arms.LEFT, Arms.BOTH: Arms.BOTH}


@dataclass(frozen=True)
class ClipTransform:
    """Transform from a motion to where a clip of it plays.

    Motion second 0 becomes stage second ``begin``, and the motion plays at ``speed`` from there. A position is mirrored
    (y becomes -y) if ``mirrored``, rotated by ``turn`` radians about Z and moved by ``shift`` metres; offsets in leg
    lengths are not moved. Constraints are active from ``first`` to ``last`` seconds.
    """

    begin: float
    speed: Speed
    turn: float
    shift: tuple[float, float]
    mirrored: bool
    first: float
    last: float

    def goes_on_in(self, after: "ClipTransform", pause: float) -> bool:
        """True if the clip of ``after`` continues the motion of this clip and starts at most ``pause`` seconds after
        its end.
        """
        ours, others = (np.array([each.begin, each.turn, *each.shift, each.mirrored]) for each in (self, after))
        alike = self.speed == after.speed and np.allclose(ours, others, rtol=0.0, atol=1e-4)
        return self.adjoins(after, pause) and bool(alike)

    def adjoins(self, after: "ClipTransform", pause: float) -> bool:
        """True if the clip of ``after`` starts at most ``pause`` seconds after this one ends, and both or neither are
        mirrored.
        """
        return -1e-9 <= after.first - self.last <= pause and self.mirrored == after.mirrored

    def stage_times(self, times: ArrayLike) -> FloatArray:
        """Stage seconds at ``times`` in motion seconds."""
        return self.begin + playing_seconds(self.speed, times)

    def retimed_keys(self, keyed: KeysKind, change: Callable[[FloatArray], FloatArray]) -> KeysKind:
        """Keys whose free tangents are transformed by ``change`` and multiplied by the playing speed."""

        def changed(tangents: Tangents | None, speed: float) -> Tangents | None:
            return tangents.with_rates(lambda rate: change(rate) * speed) if tangents else None

        speeds = speed_at(self.speed, keyed.times).tolist()
        return replace(keyed, tangents=tuple(map(changed, keyed.tangents, speeds)))

    @property
    def mean_speed(self) -> float:
        """Mean playing speed of the motion over its clip."""
        if not isinstance(self.speed, KeyedNumber):
            return self.speed
        first, last = motion_seconds(self.speed, (self.first - self.begin, self.last - self.begin)).tolist()
        return float((last - first) / (self.last - self.first)) if self.last > self.first else 1.0

    def directions(self, vectors: ArrayLike) -> FloatArray:
        """Transformed vectors (..., 3): mirrored and rotated."""
        c, s = np.cos(self.turn), np.sin(self.turn)
        seen = np.asarray(vectors, dtype=np.float64) * [1.0, -1.0 if self.mirrored else 1.0, 1.0]
        return np.asarray(seen @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]))

    def positions(self, positions: ArrayLike) -> FloatArray:
        """Transformed positions (..., 3) in metres."""
        return np.asarray(self.directions(positions) + np.array([*self.shift, 0.0]))

    def rotations(self, turns: ArrayLike, part: BodyPart) -> FloatArray:
        """Transformed rotations (..., 4) of a segment."""
        seen = np.asarray(turns, dtype=np.float64)
        if self.mirrored:
            seen = seen * [-1.0, 1.0, -1.0, 1.0]
            if is_hinged(part):
                seen = multiply(seen, np.array([0.0, 0.0, 1.0, 0.0]))
        return multiply(np.array([0.0, 0.0, np.sin(self.turn / 2), np.cos(self.turn / 2)]), seen)

    def own_rates(self, rates: ArrayLike, part: BodyPart) -> FloatArray:
        """Transformed rotation rates (..., 3), radians per second, of a segment about its own axes."""
        seen = np.asarray(rates, dtype=np.float64)
        if not self.mirrored:
            return seen
        return seen * ([1.0, -1.0, -1.0] if is_hinged(part) else [-1.0, 1.0, -1.0])

    def own_turn(self, turn: Quaternion, part: BodyPart) -> Quaternion:
        """Transformed rotation in the axes of a segment; in a mirror, of the segment of the other side."""
        if not self.mirrored:
            return turn
        x, y, z, w = turn
        return (x, -y, -z, w) if is_hinged(part) else (-x, y, -z, w)

    def body_point(self, point: BodyPoint) -> BodyPoint:
        """Transformed point of the body; in a mirror, that of the other side."""
        if not self.mirrored:
            return point
        x, y, z = point.offset
        offset = (-x, y, z) if is_hinged(point.part) else (x, -y, z)
        return replace(point, part=other_side(point.part), offset=offset)


def is_hinged(part: BodyPart) -> bool:
    """True if the x axis of a segment is a hinge."""
    return part.value.endswith(_HINGED)


def other_side(part: BodyPart) -> BodyPart:
    """Body part of the other side; a part in the middle is unchanged."""
    swaps = {"left": "right", "right": "left"}
    side, _, rest = part.value.partition("_")
    return BodyPart(f"{swaps[side]}_{rest}") if side in swaps else part


def constraint_on_clip(constraint: Constraint, carry: ClipTransform) -> Constraint:
    """Constraint transformed to where a clip of its motion plays; it still follows the same performers and props."""
    changes: dict[str, Any] = {
        "point": carry.body_point(constraint.point),
        "chain": _chain(constraint.chain, carry),
        "activation": _activation(constraint.activation, carry),
    }
    for name in (each.name for each in fields(constraint) if each.name not in ("point", "chain", "activation")):
        value = getattr(constraint, name)
        changed = _value(name, value, constraint, carry)
        if changed is not value:
            changes[name] = changed
    return replace(constraint, **changes, **constraint.carried(carry))


MIRROR_TRANSFORM = ClipTransform(0.0, 1.0, 0.0, (0.0, 0.0), True, -math.inf, math.inf)
"""Transform from a motion to its mirror image, and back."""
_SIDE_WORDS = {"left": "right", "right": "left", "Left": "Right", "Right": "Left"}
_SIDE_WORD = re.compile(rf"\b({'|'.join(_SIDE_WORDS)})\b")


def mirrored_constraint(constraint: Constraint) -> Constraint:
    """Constraint for the mirror image of its motion; a side in its name is exchanged."""
    return replace(constraint_on_clip(constraint, MIRROR_TRANSFORM), name=swapped_sides(constraint.name))


def swapped_sides(name: str) -> str:
    """Name with the words left and right exchanged."""
    return _SIDE_WORD.sub(lambda found: _SIDE_WORDS[found[0]], name)


def _value(name: str, value: Any, constraint: Constraint, carry: ClipTransform) -> Any:
    match value:
        case KeyedPlace():
            places = carry.retimed_keys(value, carry.directions)
            return replace(places, times=_keys(value, carry), values=_tuples(carry.positions(value.values)))
        case KeyedOwnPlace():
            offsets = carry.retimed_keys(value, carry.directions)
            origin = _own_place(value.origin, carry)
            return replace(
                offsets, times=_keys(value, carry), values=_tuples(carry.directions(value.values)), origin=origin
            )
        case KeyedTurn():
            if name == "tilt":
                mirrored = reflected_tilt(value, Y_MIRROR_SIGNS) if _is_heading_mirrored(constraint, carry) else value
                return replace(carry.retimed_keys(mirrored, np.asarray), times=_keys(value, carry))
            quaternions = carry.rotations(value.values, constraint.point.part)
            turned = carry.retimed_keys(value, lambda rate: carry.own_rates(rate, constraint.point.part))
            return replace(turned, times=_keys(value, carry), values=_tuples(quaternions))
        case KeyedNumber():
            turns = name == "heading"
            numbers = tuple(_heading(each, constraint, carry) for each in value.values) if turns else value.values
            sign = -1.0 if turns and _is_heading_mirrored(constraint, carry) else 1.0
            scalars = carry.retimed_keys(value, lambda rate: sign * rate)
            return replace(scalars, times=_keys(value, carry), values=numbers)
        case CirclePlace() | PendulumPlace() | NoisePlace():
            (x, y, z), seen = carry.positions(value.centre).tolist(), value.mirrored() if carry.mirrored else value
            if value.origin is not None:
                x, y, z = carry.directions(value.centre).tolist()
            return replace(
                seen,
                centre=(x, y, z),
                heading=seen.heading + carry.turn,
                seconds=value.seconds / carry.mean_speed,
                since=float(carry.stage_times(value.since)),
                origin=_own_place(value.origin, carry) if value.origin is not None else None,
            )
        case OwnPlace():
            return _own_place(value, carry)
        case BodyPoint():
            return carry.body_point(value)
        case FollowBody():
            return replace(
                value, point=carry.body_point(value.point), turn=carry.own_turn(value.turn, value.point.part)
            )
        case Arms():
            return _SWAPPED[value] if carry.mirrored else value
        case TriangleMesh() if carry.mirrored:
            return TriangleMesh(value.vertices * [1.0, -1.0, 1.0], value.triangles[:, ::-1])
    return _plain(name, value, constraint, carry)


def _own_place(place: OwnPlace, carry: ClipTransform) -> OwnPlace:
    x, y, z = carry.directions(place.offset).tolist()
    return replace(
        place,
        point=carry.body_point(place.point),
        time=float(carry.stage_times(place.time)),
        offset=(x, y, z),
        own=tuple((key, tuple(carry.directions(each).tolist())) for key, each in place.own),
    )


def _plain(name: str, value: Any, constraint: Constraint, carry: ClipTransform) -> Any:
    if name == "heading":
        return _heading(value, constraint, carry)
    if name == "tilt":
        return reflected_tilt(value, Y_MIRROR_SIGNS) if _is_heading_mirrored(constraint, carry) else value
    if name == "size" and isinstance(constraint, AreaConstraint) and constraint.shape is AreaShape.HALF_SPACE:
        x, y, z = value
        return (x, -y, z) if carry.mirrored else value
    if name not in ("target", "other", "centre", "place") or not isinstance(value, tuple):
        return value
    if len(value) == 4:
        return tuple(carry.rotations(value, constraint.point.part).tolist())
    return tuple(carry.positions((*value, 0.0)[:3]).tolist()[: len(value)])


def _heading(heading: float, constraint: Constraint, carry: ClipTransform) -> float:
    """Heading, mirrored if the clip is, and rotated with the clip unless the centre follows an object."""
    follows = isinstance(getattr(constraint, "centre", None), FOLLOWS)
    seen = -heading if _is_heading_mirrored(constraint, carry) else heading
    return seen if follows else seen + carry.turn


def reflected_tilt(tilt: Quaternion | KeyedTurn, signs: Vector) -> Any:
    """Rotation of a volume in a mirror with the ``signs`` of the axes."""
    axes = -np.array(signs)
    if isinstance(tilt, KeyedTurn):
        values = _tuples(np.array(tilt.values) * [*axes, 1.0])
        return replace(tilt.with_rates(lambda rate: rate * axes), values=values)
    return tuple((np.array(tilt) * [*axes, 1.0] + 0.0).tolist())


def _is_heading_mirrored(constraint: Constraint, carry: ClipTransform) -> bool:
    others = isinstance(getattr(constraint, "centre", None), FollowPerformer | FollowProp)
    return carry.mirrored and not others


def _chain(chain: Chain, carry: ClipTransform) -> Chain:
    if not carry.mirrored:
        return chain
    return replace(chain, segments=tuple((other_side(part), weight) for part, weight in chain.segments))


def _activation(curve: ActivationCurve, carry: ClipTransform) -> ActivationCurve:
    """Activation limited to the clip: a curve that starts before the clip fades in at its begin.

    It is ``NEVER_ACTIVE`` if there is no time to fade in and out, or if other clips cover this one.
    """
    if carry.last < carry.first:
        return NEVER_ACTIVE
    start, full, full_end, end = carry.stage_times(curve.times).tolist()
    coming = min(BOUNDARY_FADE_SECONDS, (carry.last - carry.first) / 2)
    if start < carry.first:
        start, full = carry.first, max(full, carry.first + coming)
    if end > carry.last:
        full_end, end = min(full_end, carry.last - coming), carry.last
    if full > full_end + 1e-9:
        return NEVER_ACTIVE
    times = np.maximum.accumulate([start, full, full_end, end]).tolist()
    return curve.with_times(*times)


def _keys(keyed: Keys, carry: ClipTransform) -> tuple[float, ...]:
    return tuple(carry.stage_times(keyed.times).tolist())


def _tuples(rows: FloatArray) -> Any:
    return tuple(tuple(row) for row in rows.tolist())
