"""Targets as arrays over time: fixed, keyed, procedural and followed ones."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import Support
from studio.core.constraints.base import Constraint, Vector
from studio.core.constraints.follow import FOLLOWS, Follow, FollowProp, FollowTracked
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.target import Place, Turn
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, Quaternion
from studio.core.rotations import from_matrix, normalized, shortest_arc, to_matrix

if TYPE_CHECKING:
    from studio.core.solver.request import UnconstrainedPoses

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Track:
    """Track of a followed object: ``places`` (F, 3) metres and ``rotations`` (F, 3, 3), or one frame for all."""

    positions: FloatArray
    rotations: FloatArray

    def in_frames(self, window: slice) -> "Track":
        """The frames of ``window``."""
        return self if len(self.positions) == 1 else Track(self.positions[window], self.rotations[window])


@dataclass(frozen=True, eq=False)
class OwnPath:
    """Track of an object that moves with the grounded body itself, known after grounding."""

    make: "Callable[[UnconstrainedPoses, AnyMorphology], Track]"


Tracks = Mapping[Follow | OwnPlace | Support, Track | OwnPath]


@dataclass(frozen=True, eq=False)
class Targets:
    """Evaluation of targets: ``times`` (F,) seconds, the ``tracks`` of followed objects, ``masses()`` (F, 3) the
    motion's own centre of mass, and the body's ``leg_length`` in metres. Every result has F frames, or one for all.
    """

    times: FloatArray
    tracks: Mapping[Follow | OwnPlace | Support, Track]
    masses: Callable[[], FloatArray]
    leg_length: float

    def positions(self, target: Place | Support) -> FloatArray:
        """Positions (F or 1, 3) in metres."""
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
        """Rotations (F or 1, 3, 3)."""
        if isinstance(target, KeyedTurn):
            return target.at(self.times)
        if isinstance(target, FOLLOWS):
            return self.tracks[target].rotations
        return to_matrix(np.array(target))[None]

    def numbers(self, value: float | KeyedNumber) -> FloatArray:
        """Values (F or 1,)."""
        return value.at(self.times)[:, 0] if isinstance(value, KeyedNumber) else np.array([value])

    def tilted_rotations(self, heading: float | KeyedNumber, centre: Place, normal: Vector) -> FloatArray:
        """Rotations (F or 1, 3, 3) that take x to a half-space's ``normal``: like ``heading_rotations``,
        and tilted by a followed prop, but not by a followed bone.
        """
        x_to_normal = shortest_arc(np.array([[1.0, 0.0, 0.0]]), normalized(np.array([normal])))[0]
        if isinstance(centre, FollowProp) and centre in self.tracks:
            rotation_matrices = (
                self.tracks[centre].rotations @ self.heading_rotations(heading, (0.0, 0.0, 0.0)) @ x_to_normal
            )
        else:
            rotation_matrices = self.heading_rotations(heading, centre) @ x_to_normal
        return np.asarray(rotation_matrices)

    def heading_rotations(self, heading: float | KeyedNumber, centre: Place) -> FloatArray:
        """Rotations (F or 1, 3, 3) about Z: ``heading`` (radians) plus that of the object that ``centre`` follows.

        That of the own body is unknown before solving, and added by the kernels.
        """
        angles = self.numbers(heading)
        if isinstance(centre, FOLLOWS) and centre in self.tracks:
            axes = self.tracks[centre].rotations
            angles = angles + np.arctan2(axes[:, 1, 0] - axes[:, 0, 1], axes[:, 0, 0] + axes[:, 1, 1])
        rotation_matrices = np.zeros((len(angles), 3, 3))
        rotation_matrices[:, 0, 0] = rotation_matrices[:, 1, 1] = np.cos(angles)
        rotation_matrices[:, 1, 0] = np.sin(angles)
        rotation_matrices[:, 0, 1] = -rotation_matrices[:, 1, 0]
        rotation_matrices[:, 2, 2] = 1.0
        return rotation_matrices


def fixed_at(constraint: Constraint, targets: Targets) -> Constraint:
    """The constraint at the first time of ``targets``, with keyed and followed values as plain numbers."""
    changes: dict[str, Any] = {}
    for name in (field.name for field in fields(constraint)):
        value = getattr(constraint, name)
        if isinstance(value, KeyedTurn) or (isinstance(value, FOLLOWS) and constraint.kind == "orientation"):
            changes[name] = tuple(from_matrix(targets.rotations(value)[0]).tolist())
        elif isinstance(value, (KeyedPlace, KeyedOwnPlace, ProceduralPlace, OwnPlace, *FOLLOWS)):
            changes[name] = tuple(targets.positions(value)[0].tolist())
        elif isinstance(value, KeyedNumber):
            changes[name] = float(targets.numbers(value)[0])
    if "centre" in changes and isinstance(constraint, AreaConstraint) and constraint.shape is AreaShape.HALF_SPACE:
        tilt = targets.tilted_rotations(constraint.heading, constraint.centre, constraint.size)[0]
        changes["size"], changes["heading"] = tuple(tilt[:, 0].tolist()), 0.0
    elif "centre" in changes and isinstance(constraint, RailConstraint):
        tilt = targets.tilted_rotations(0.0, constraint.centre, constraint.direction)[0]
        changes["direction"] = tuple(tilt[:, 0].tolist())
    elif "centre" in changes and hasattr(constraint, "heading"):
        rotation = targets.heading_rotations(constraint.heading, getattr(constraint, "centre", (0.0, 0.0, 0.0)))[0]
        changes["heading"] = float(np.arctan2(rotation[1, 0], rotation[0, 0]))
    return replace(constraint, **changes) if changes else constraint


def moved_target(target: Place, position: Vector, seconds: float, track: Track | None) -> Place:
    """``target`` moved to ``position`` at ``seconds``: with a key, another centre of a rule, or another offset from a
    followed object, whose ``track`` begins at that time.
    """
    if isinstance(target, KeyedPlace):
        return target.with_key(seconds, position)
    if isinstance(target, ProceduralPlace):
        return target.passing(position, seconds)
    if not isinstance(target, FOLLOWS) or track is None:
        return position
    axes = track.rotations[0] @ to_matrix(np.array(target.turn)).T
    further = axes.T @ (np.array(position) - track.positions[0])
    if isinstance(target, FollowProp | FollowTracked):
        return replace(target, offset=_sum(target.offset, further))
    return replace(target, point=replace(target.point, offset=_sum(target.point.offset, further)))


def turned_target(target: Turn, rotation: Quaternion, seconds: float, track: Track | None) -> Turn:
    """``target`` rotated like ``moved_target``."""
    if isinstance(target, KeyedTurn):
        return target.with_key(seconds, rotation)
    if not isinstance(target, FOLLOWS) or track is None:
        return rotation
    axes = track.rotations[0] @ to_matrix(np.array(target.turn)).T
    return replace(target, turn=tuple(from_matrix(axes.T @ to_matrix(np.array(rotation))).tolist()))


def _sum(offset: Vector, further: FloatArray) -> Vector:
    x, y, z = (np.array(offset) + further).tolist()
    return x, y, z
