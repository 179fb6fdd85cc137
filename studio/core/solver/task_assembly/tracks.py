"""Targets over time: fixed, keyed, procedural and followed ones as arrays."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.body.morphology import AnyMorphology
from studio.core.compact_array import PoseArray
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import Support
from studio.core.constraints.base import Constraint, Vector
from studio.core.constraints.follow import FOLLOWS, Follow, FollowProp, FollowTracked
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.target import Place, Turn
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, Quaternion
from studio.core.rotations import from_euler, from_matrix, normalized, rotations_about_z, shortest_arc, to_matrix

if TYPE_CHECKING:
    from studio.core.solver.request import UnconstrainedPoses

FloatArray = NDArray[np.float64]
FINGER_RAISE_FRACTION = 2.0 / 3.0
"""Fraction of the arms' elevation by which fingers on a prop are raised; wrists bend by the rest."""


@dataclass(frozen=True, eq=False)
class Track:
    """Positions and rotations of a followed object over time, F frames or one for all."""

    positions: FloatArray
    """(F or 1, 3) metres."""
    rotations: FloatArray
    """(F or 1, 3, 3)."""

    def in_frames(self, window: slice) -> "Track":
        """Track in the frames of ``window``."""
        return self if len(self.positions) == 1 else Track(self.positions[window], self.rotations[window])


def raised_along_arms(
    follow: Follow | OwnPlace | Support, track: Track, positions: PoseArray, layout: BodyLayout
) -> Track:
    """Hand target ``track``, pitched up by a fraction of the arms' elevation if ``follow`` aligns the hand with them.

    The elevation is that of the line from the middle of the shoulders of a body with ``positions`` (F, P, 3) to the
    followed point of the prop. Any other track is returned unchanged.
    """
    if not (isinstance(follow, FollowProp) and follow.along_arms):
        return track
    shoulders = (positions[:, layout.collar_point(0) + 1] + positions[:, layout.collar_point(1) + 1]) / 2
    _, down, ahead = np.einsum("fji,fj->if", track.rotations, track.positions - shoulders)  # in the axes of a flat hand
    angles = FINGER_RAISE_FRACTION * np.arctan2(-down, np.abs(ahead))
    rotations = track.rotations @ to_matrix(from_euler("X", angles[:, None]))
    return Track(track.positions + rotations @ np.array(follow.offset), rotations)


@dataclass(frozen=True, eq=False)
class OwnPath:
    """Track of an object that moves with the grounded body itself, so that it is known only after grounding."""

    make: "Callable[[UnconstrainedPoses, AnyMorphology], Track]"
    """Computes the track from the grounded poses."""


Tracks = Mapping[Follow | OwnPlace | Support, Track | OwnPath]
"""Tracks by followed target."""


@dataclass(frozen=True, eq=False)
class Targets:
    """Evaluates targets at given times. Every result has F frames, or one for all."""

    times: FloatArray
    """(F,) seconds."""
    tracks: Mapping[Follow | OwnPlace | Support, Track]
    """Tracks of followed objects."""
    masses: Callable[[], FloatArray]
    """Computes the motion's own centre of mass (F, 3)."""
    leg_length: float
    """Leg length of the body in metres."""

    def positions(self, target: Place | Support) -> FloatArray:
        """Positions (F or 1, 3) of a target in metres."""
        if isinstance(target, KeyedOwnPlace):
            return self.tracks[target.origin].positions + self.leg_length * target.at(self.times)
        if isinstance(target, ProceduralPlace) and target.origin is not None:
            return self.tracks[target.origin].positions + target.at(self.times)
        if isinstance(target, KeyedPlace | ProceduralPlace):
            return target.at(self.times)
        if isinstance(target, (*FOLLOWS, OwnPlace, Support)):
            return self.tracks[target].positions
        return np.array(target, dtype=np.float64)[None]

    def rotations(self, target: Turn) -> FloatArray:
        """Rotations (F or 1, 3, 3) of a target."""
        if isinstance(target, KeyedTurn):
            return target.at(self.times)
        if isinstance(target, FOLLOWS):
            return self.tracks[target].rotations
        return to_matrix(np.array(target))[None]

    def numbers(self, value: float | KeyedNumber) -> FloatArray:
        """Values (F or 1,) of a constant or keyed number."""
        return value.at(self.times)[:, 0] if isinstance(value, KeyedNumber) else np.array([value])

    def area_rotations(self, area: AreaConstraint) -> FloatArray:
        """Rotations (F or 1, 3, 3) of an area; those of a half-space take x to its normal."""
        tilts = rotation_from_x(area.size) if area.shape is AreaShape.HALF_SPACE else self.rotations(area.tilt)
        return self._headed(tilts, area.heading, area.centre)

    def rail_rotations(self, rail: RailConstraint) -> FloatArray:
        """Rotations (F or 1, 3, 3) of a rail, which take x to its direction."""
        return self._headed(rotation_from_x(rail.direction), 0.0, rail.centre)

    def _headed(self, tilts: FloatArray, heading: float | KeyedNumber, centre: Place) -> FloatArray:
        """``tilts`` (F or 1, 3, 3) rotated by ``heading`` and by the object that ``centre`` follows.

        A followed prop also tilts them; a followed bone only adds its heading.
        """
        if isinstance(centre, FollowProp) and centre in self.tracks:
            headings = self.tracks[centre].rotations @ self.heading_rotations(heading, (0.0, 0.0, 0.0))
        else:
            headings = self.heading_rotations(heading, centre)
        return np.asarray(headings @ tilts)

    def heading_rotations(self, heading: float | KeyedNumber, centre: Place) -> FloatArray:
        """Rotations (F or 1, 3, 3) about Z by ``heading`` (radians) plus the heading of the object that ``centre``
        follows.

        The heading of the own body is unknown before solving, and added by the kernels.
        """
        angles = self.numbers(heading)
        if isinstance(centre, FOLLOWS) and centre in self.tracks:
            axes = self.tracks[centre].rotations
            angles = angles + np.arctan2(axes[:, 1, 0] - axes[:, 0, 1], axes[:, 0, 0] + axes[:, 1, 1])
        return rotations_about_z(angles)


def fixed_at(constraint: Constraint, targets: Targets) -> Constraint:
    """``constraint`` at the first time of ``targets``, with keyed and followed values replaced by plain numbers."""
    changes: dict[str, Any] = {}
    for name, value in vars(constraint).items():
        if not hasattr(value, "kind"):  # a plain number, name or record; keyed and followed values have kinds
            continue
        if isinstance(value, KeyedTurn) or (isinstance(value, FOLLOWS) and constraint.kind == "orientation"):
            changes[name] = tuple(from_matrix(targets.rotations(value)[0]).tolist())
        elif isinstance(value, (KeyedPlace, KeyedOwnPlace, ProceduralPlace, OwnPlace, *FOLLOWS)):
            changes[name] = tuple(targets.positions(value)[0].tolist())
        elif isinstance(value, KeyedNumber):
            changes[name] = float(targets.numbers(value)[0])
    if "centre" in changes and isinstance(constraint, AreaConstraint) and constraint.shape is AreaShape.HALF_SPACE:
        tilt = targets.area_rotations(constraint)[0]
        changes["size"], changes["heading"] = tuple(tilt[:, 0].tolist()), 0.0
    elif "centre" in changes and isinstance(constraint, RailConstraint):
        tilt = targets.rail_rotations(constraint)[0]
        changes["direction"] = tuple(tilt[:, 0].tolist())
    elif "centre" in changes and isinstance(constraint, AreaConstraint):
        rotation = targets.area_rotations(constraint)[0]
        headed = rotation @ targets.rotations(constraint.tilt)[0].T
        heading = math.atan2(headed[1, 0] - headed[0, 1], headed[0, 0] + headed[1, 1])
        tilt = rotations_about_z(-heading) @ rotation
        changes["heading"], changes["tilt"] = heading, tuple(from_matrix(tilt).tolist())
    return replace(constraint, **changes) if changes else constraint


def rotation_from_x(direction: Vector) -> FloatArray:
    """Shortest rotation (3, 3) that takes x to ``direction``."""
    return np.asarray(shortest_arc(np.array([[1.0, 0.0, 0.0]]), normalized(np.array([direction])))[0])


def moved_target(target: Place, position: Vector, seconds: float, track: Track | None) -> Place:
    """``target`` moved to ``position`` at ``seconds``.

    A keyed target gets a key, a procedural one another centre, a followed one another offset from the object; ``track``
    is that of the object, beginning at that time.
    """
    if isinstance(target, KeyedPlace):
        return target.with_key(seconds, position)
    if isinstance(target, ProceduralPlace):
        return target.passing(position, seconds)
    if not isinstance(target, FOLLOWS) or track is None:
        return position
    axes = track.rotations[0]
    if not (isinstance(target, FollowProp) and target.along_arms):
        axes = axes @ to_matrix(np.array(target.turn)).T
    further = axes.T @ (np.array(position) - track.positions[0])
    if isinstance(target, FollowProp | FollowTracked):
        return replace(target, offset=_sum(target.offset, further))
    return replace(target, point=replace(target.point, offset=_sum(target.point.offset, further)))


def turned_target(target: Turn, rotation: Quaternion, seconds: float, track: Track | None) -> Turn:
    """``target`` rotated to ``rotation`` at ``seconds``.

    A keyed target gets a key, a followed one another rotation relative to the object; ``track`` is that of the object,
    beginning at that time.
    """
    if isinstance(target, KeyedTurn):
        return target.with_key(seconds, rotation)
    if not isinstance(target, FOLLOWS) or track is None:
        return rotation
    axes = track.rotations[0] @ to_matrix(np.array(target.turn)).T
    return replace(target, turn=tuple(from_matrix(axes.T @ to_matrix(np.array(rotation))).tolist()))


def _sum(offset: Vector, further: FloatArray) -> Vector:
    """Sum of two offsets (3,)."""
    x, y, z = (np.array(offset) + further).tolist()
    return x, y, z
