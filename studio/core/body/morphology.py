"""Morphology: the measures of one body, which a character adds to a morphology-independent motion."""

from dataclasses import dataclass, field, fields, replace
from functools import cached_property, lru_cache
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.kernels import measure_columns as measure
from studio.core.plausible import BONE_RANGE
from studio.core.rotations import unit_vectors

FloatArray = NDArray[np.float64]

_SHAPES: dict[str, tuple[int, ...]] = {
    "neck": (),
    "head": (),
    "collar_base": (2, 3),
    "clavicle": (2,),
    "arm": (2, 2),
    "hand": (2, 3),
    "hip_offset": (2, 3),
    "leg": (2, 2),
    "foot": (2, 3),
    "toe": (2, 3),
    "ankle_height": (2,),
    "toe_height": (2,),
    "heel_length": (2,),
    "neck_rest": (3,),
    "clavicle_rest": (2, 3),
}
_LENGTHS = ("neck", "head", "clavicle", "arm", "leg")
_DIRECTIONS = ("neck_rest", "clavicle_rest")


@dataclass(frozen=True)
class Morphology:
    """Measures of a body in metres; vectors are in the axes of their own segment (``canonical``).

    Raises ValueError with the field's name if a shape is wrong, a number is not finite or a bone has no length.
    """

    spine: FloatArray
    """(K, 3) from each spine joint to the next; the last ends at the neck base."""
    neck: float
    head: float
    collar_base: FloatArray
    """(2, 3) from the neck base to where each clavicle begins, thorax axes."""
    clavicle: FloatArray
    arm: FloatArray
    """(2, 2) upper arm, forearm of each side."""
    hand: FloatArray
    """(2, 3) wrist to end of hand, hand axes."""
    hip_offset: FloatArray
    """(2, 3) root to hip joint, pelvis axes."""
    leg: FloatArray
    """(2, 2) thigh, shank of each side."""
    foot: FloatArray
    """(2, 3) ankle to toe joint, foot axes (sole flat at identity)."""
    toe: FloatArray
    """(2, 3) toe joint to end of toe, toe axes."""
    ankle_height: FloatArray
    """(2,) ankle joint above the sole of the flat foot."""
    toe_height: FloatArray
    """(2,) toe joint above the sole of the flat foot."""
    heel_length: FloatArray
    """(2,) from below the ankle back to the heel."""
    neck_rest: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    """(3,) direction of the neck in the body at ease, thorax axes."""
    clavicle_rest: FloatArray = field(default_factory=lambda: np.array([[-0.2, 1.0, 0.05], [-0.2, -1.0, 0.05]]))
    """(2, 3) direction of each clavicle in the body at ease, thorax axes."""

    def __post_init__(self) -> None:
        spine = np.array(self.spine, dtype=np.float64)
        if spine.ndim != 2 or spine.shape[0] < 2 or spine.shape[1] != 3:
            raise ValueError(f"spine: expected (K, 3) with K of at least 2, got {spine.shape}.")
        object.__setattr__(self, "spine", spine)
        for name, shape in _SHAPES.items():
            array = np.array(getattr(self, name), dtype=np.float64)
            if array.shape != shape:
                raise ValueError(f"{name}: expected shape {shape}, got {array.shape}.")
            object.__setattr__(self, name, float(array) if shape == () else array)
        for name in ("spine", *_SHAPES):
            array = np.asarray(getattr(self, name))
            if not np.isfinite(array).all():
                raise ValueError(f"{name}: holds a number that is not finite.")
            BONE_RANGE.check(array)
            if name in _LENGTHS and (array <= 0).any():
                raise ValueError(f"{name}: a bone needs a length above zero.")
            if name in _DIRECTIONS:
                if (np.linalg.norm(array, axis=-1) < 1e-9).any():
                    raise ValueError(f"{name}: a direction needs a length above zero.")
                object.__setattr__(self, name, unit_vectors(array))
            if isinstance(getattr(self, name), np.ndarray):
                getattr(self, name).setflags(write=False)

    @cached_property
    def layout(self) -> BodyLayout:
        return BodyLayout(len(self.spine))

    @property
    def leg_length(self) -> float:
        """Mean of both legs, hip to ankle."""
        return float(self.leg.sum() / 2)

    @property
    def spine_length(self) -> float:
        return float(np.linalg.norm(self.spine, axis=1).sum())

    @cached_property
    def stature(self) -> float:
        """Standing height, sole to crown."""
        hips = self.leg_length + float(self.ankle_height.mean()) - float(self.hip_offset[:, 2].mean())
        return hips + float(self.spine[:, 2].sum()) + self.neck + self.head

    @cached_property
    def packed(self) -> FloatArray:
        """All measures in one row for the kernels, in the columns of ``kernels.measure_columns``."""
        row = np.concatenate([np.ravel(getattr(self, name)) for name in (*_SHAPES, "spine")])
        row.setflags(write=False)
        return row

    @property
    def first_frame_body(self) -> Self:
        """The morphology itself, so that it can stand for an animated one."""
        return self

    @cached_property
    def rows(self) -> FloatArray:
        """(1, 57 + 3 K) ``packed`` as an animation of one constant row."""
        return self.packed[None]

    def to_json(self) -> dict[str, Any]:
        return {name: np.asarray(getattr(self, name)).tolist() for name in ("spine", *_SHAPES)}

    @classmethod
    def from_json(cls, record: dict[str, Any]) -> Self:
        """Morphology in a JSON ``record``. Raises ValueError naming a missing or wrong field."""
        missing = [name for name in ("spine", *_SHAPES) if name not in record]
        if missing:
            raise ValueError(f"A morphology needs {', '.join(missing)}.")
        return cls(**{name: record[name] for name in ("spine", *_SHAPES)})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Morphology) and np.array_equal(self.packed, other.packed)

    def __hash__(self) -> int:
        return hash(self._bytes)

    @cached_property
    def _bytes(self) -> bytes:
        """Bytes that are hashed; the hash itself is not kept, because it differs between processes."""
        return self.packed.tobytes()


@dataclass(frozen=True, eq=False)
class AnimatedMorphology:
    """Body whose measures change from frame to frame: ``rows`` (F, 57 + 3 K), each the ``packed`` of a morphology.

    Made by ``from_bodies``. Raises ValueError if a bone has no length in some frame or a number is not finite.
    """

    rows: FloatArray

    def __post_init__(self) -> None:
        rows = np.array(self.rows, dtype=np.float64)
        if rows.ndim != 2 or not len(rows) or rows.shape[1] < measure.SPINE + 6 or rows.shape[1] % 3:
            raise ValueError(f"rows: expected a row of measures a frame, got {rows.shape}.")
        if not np.isfinite(rows).all():
            raise ValueError("rows: holds a number that is not finite.")
        lengths = (
            measure.NECK,
            measure.HEAD,
            *range(measure.CLAVICLE, measure.HAND),
            *range(measure.LEG, measure.FOOT),
        )
        if (rows[:, lengths] <= 0.0).any():
            frame = int(np.argmax((rows[:, lengths] <= 0.0).any(axis=1)))
            raise ValueError(f"rows: a bone needs a length above zero, in frame {frame} one has none.")
        rows.setflags(write=False)
        object.__setattr__(self, "rows", rows)

    @classmethod
    def from_bodies(cls, first: Morphology, second: Morphology, shares: FloatArray) -> Self:
        """Interpolation of two bodies of one layout: ``first`` where the fraction (F,) is 0,
        ``second`` where it is 1.
        """
        if first.layout != second.layout:
            raise ValueError("A body can only grow into one with as many spine segments.")
        return cls(first.packed + np.asarray(shares)[:, None] * (second.packed - first.packed))

    @cached_property
    def layout(self) -> BodyLayout:
        return BodyLayout((self.rows.shape[1] - measure.SPINE) // 3)

    @cached_property
    def first_frame_body(self) -> Morphology:
        """Body of the first frame."""
        return self.at(0)

    def at(self, frame: int) -> Morphology:
        """Body of one frame."""
        row, measures, start = self.rows[frame], {}, 0
        for name, shape in (*_SHAPES.items(), ("spine", (self.layout.spine_count, 3))):
            size = int(np.prod(shape))
            measures[name], start = row[start : start + size].reshape(shape), start + size
        return Morphology(**measures)

    @property
    def spine(self) -> FloatArray:
        """(K, 3) spine of the first frame; its proportions distribute the motion's rotations over the vertebrae."""
        return self.rows[0, measure.SPINE :].reshape(-1, 3)

    @property
    def leg_length(self) -> float:
        """Mean of both legs over all frames, hip to ankle."""
        return float(self.rows[:, measure.LEG : measure.FOOT].sum(axis=1).mean() / 2)


AnyMorphology = Morphology | AnimatedMorphology


@lru_cache(maxsize=64)
def sole_rows(body: AnyMorphology, side: int) -> FloatArray:
    """(F or 1, 6) metres of one foot: ankle to toe joint in foot axes (3), height of the ankle over the sole, distance
    of the heel behind the ankle, length of the toe along the ground.
    """
    rows, foot, toe = body.rows, measure.FOOT + 3 * side, measure.TOE + 3 * side
    heights = rows[:, [measure.ANKLE_HEIGHT + side, measure.HEEL_LENGTH + side]]
    toes = np.hypot(rows[:, toe], rows[:, toe + 1])
    return np.ascontiguousarray(np.column_stack([rows[:, foot : foot + 3], heights, toes]))


def arm_rows(body: AnyMorphology, side: int) -> FloatArray:
    """(F or 1, 2) metres of an upper arm and a forearm."""
    return body.rows[:, measure.ARM + 2 * side : measure.ARM + 2 * side + 2]


def leg_rows(body: AnyMorphology, side: int) -> FloatArray:
    """(F or 1, 2) metres of a thigh and a shank."""
    return body.rows[:, measure.LEG + 2 * side : measure.LEG + 2 * side + 2]


def at_frames(rows: FloatArray, frames: Any) -> FloatArray:
    """Rows of the given ``frames``, (len(frames) or 1, N), of ``rows`` (F or 1, N); a single row holds
    for all frames.
    """
    return rows if len(rows) == 1 else rows[frames]


LEAST_PROPORTION_FACTOR, MOST_PROPORTION_FACTOR = 0.2, 5.0


@dataclass(frozen=True)
class Proportions:
    """Factors on a build's measures, set by the sliders of the inspector; all are 1 for the build itself."""

    stature: float = 1.0
    trunk: float = 1.0
    shoulders: float = 1.0
    hips: float = 1.0
    upper_arms: float = 1.0
    forearms: float = 1.0
    hands: float = 1.0
    thighs: float = 1.0
    shanks: float = 1.0
    feet: float = 1.0
    head: float = 1.0

    def __post_init__(self) -> None:
        for each in fields(self):
            factor = getattr(self, each.name)
            if not (np.isfinite(factor) and LEAST_PROPORTION_FACTOR <= factor <= MOST_PROPORTION_FACTOR):
                limits = f"{LEAST_PROPORTION_FACTOR:g} and {MOST_PROPORTION_FACTOR:g}"
                raise ValueError(f"{each.name}: a proportion lies between {limits}, got {factor}.")

    def applied_to(self, build: Morphology) -> Morphology:
        """``build`` with its measures multiplied by these factors."""
        whole = self.stature
        feet = whole * self.feet
        return replace(
            build,
            spine=build.spine * whole * self.trunk,
            neck=build.neck * whole * self.head,
            head=build.head * whole * self.head,
            collar_base=build.collar_base * whole * np.array([self.trunk, self.shoulders, self.trunk]),
            clavicle=build.clavicle * whole * self.shoulders,
            arm=build.arm * whole * np.array([self.upper_arms, self.forearms]),
            hand=build.hand * whole * self.hands,
            hip_offset=build.hip_offset * whole * np.array([1.0, self.hips, 1.0]),
            leg=build.leg * whole * np.array([self.thighs, self.shanks]),
            foot=build.foot * feet,
            toe=build.toe * feet,
            ankle_height=build.ankle_height * feet,
            toe_height=build.toe_height * feet,
            heel_length=build.heel_length * feet,
        )
