"""Morphology: the measures of one body, which turn a morphology-independent motion into poses."""

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
    """Measures of a body in metres; vectors are in the axes of their own segment (see ``canonical``).

    Raises ValueError, which names the field, if a shape is wrong, a number is not finite or a bone has no length.
    """

    spine: FloatArray
    """Vectors (K, 3) from each spine joint to the next; the last ends at the neck base."""
    neck: float
    head: float
    collar_base: FloatArray
    """Vectors (2, 3) from the neck base to the begin of each clavicle, in thorax axes."""
    clavicle: FloatArray
    arm: FloatArray
    """Lengths (2, 2) of upper arm and forearm of each side."""
    hand: FloatArray
    """Vectors (2, 3) from wrist to end of hand, in hand axes."""
    hip_offset: FloatArray
    """Vectors (2, 3) from root to hip joint, in pelvis axes."""
    leg: FloatArray
    """Lengths (2, 2) of thigh and shank of each side."""
    foot: FloatArray
    """Vectors (2, 3) from ankle to toe joint, in foot axes (identity when the sole is flat)."""
    toe: FloatArray
    """Vectors (2, 3) from toe joint to end of toe, in toe axes."""
    ankle_height: FloatArray
    """Heights (2,) of the ankle joints above the soles of flat feet."""
    toe_height: FloatArray
    """Heights (2,) of the toe joints above the soles of flat feet."""
    heel_length: FloatArray
    """Horizontal distances (2,) from the ankle back to the heel."""
    neck_rest: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    """Direction (3,) of the neck of the body at ease, in thorax axes."""
    clavicle_rest: FloatArray = field(default_factory=lambda: np.array([[-0.2, 1.0, 0.05], [-0.2, -1.0, 0.05]]))
    """Directions (2, 3) of the clavicles of the body at ease, in thorax axes."""

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
        """Indices of the body's points and segments."""
        return BodyLayout(len(self.spine))

    @property
    def leg_length(self) -> float:
        """Mean length of both legs from hip to ankle."""
        return float(self.leg.sum() / 2)

    @property
    def spine_length(self) -> float:
        """Sum of the lengths of the spine's segments."""
        return float(np.linalg.norm(self.spine, axis=1).sum())

    @cached_property
    def stature(self) -> float:
        """Standing height from sole to crown."""
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
        """The morphology itself, as the counterpart of ``AnimatedMorphology.first_frame_body``."""
        return self

    @cached_property
    def rows(self) -> FloatArray:
        """All measures as one row (1, 57 + 3 K) for K spine segments, columns as in ``kernels.measure_columns``."""
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
    """Body whose measures change from frame to frame: ``rows`` (F, 57 + 3 K) are ``packed`` measures of a morphology.

    Make one by ``from_bodies``. Raises ValueError if a bone has no length in some frame or a number is not finite.
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
        """Interpolation of two bodies with one layout: ``first`` where ``shares`` (F,) is 0, ``second``
        where it is 1.
        """
        if first.layout != second.layout:
            raise ValueError("A body can only grow into one with as many spine segments.")
        return cls(first.packed + np.asarray(shares)[:, None] * (second.packed - first.packed))

    @cached_property
    def layout(self) -> BodyLayout:
        return BodyLayout((self.rows.shape[1] - measure.SPINE) // 3)

    @cached_property
    def first_frame_body(self) -> Morphology:
        """Morphology in the first frame."""
        return self.at(0)

    def at(self, frame: int) -> Morphology:
        """Morphology in ``frame``."""
        row, measures, start = self.rows[frame], {}, 0
        for name, shape in (*_SHAPES.items(), ("spine", (self.layout.spine_count, 3))):
            size = int(np.prod(shape))
            measures[name], start = row[start : start + size].reshape(shape), start + size
        return Morphology(**measures)

    @property
    def spine(self) -> FloatArray:
        """Vectors (K, 3) of the spine in the first frame; their proportions distribute the motion's rotations over the
        vertebrae.
        """
        return self.rows[0, measure.SPINE :].reshape(-1, 3)

    @property
    def leg_length(self) -> float:
        """Mean length of both legs from hip to ankle, over all frames."""
        return float(self.rows[:, measure.LEG : measure.FOOT].sum(axis=1).mean() / 2)


AnyMorphology = Morphology | AnimatedMorphology


@lru_cache(maxsize=64)
def sole_rows(body: AnyMorphology, side: int) -> FloatArray:
    """Measures (F or 1, 6) in metres of one foot, for a sole on the ground.

    Columns: vector from ankle to toe joint in foot axes (3), height of the ankle above the sole, distance of the heel
    behind the ankle, length of the toe along the ground.
    """
    rows, foot, toe = body.rows, measure.FOOT + 3 * side, measure.TOE + 3 * side
    heights = rows[:, [measure.ANKLE_HEIGHT + side, measure.HEEL_LENGTH + side]]
    toes = np.hypot(rows[:, toe], rows[:, toe + 1])
    return np.ascontiguousarray(np.column_stack([rows[:, foot : foot + 3], heights, toes]))


def arm_rows(body: AnyMorphology, side: int) -> FloatArray:
    """Lengths (F or 1, 2) in metres of upper arm and forearm."""
    return body.rows[:, measure.ARM + 2 * side : measure.ARM + 2 * side + 2]


def leg_rows(body: AnyMorphology, side: int) -> FloatArray:
    """Lengths (F or 1, 2) in metres of thigh and shank."""
    return body.rows[:, measure.LEG + 2 * side : measure.LEG + 2 * side + 2]


def at_frames(rows: FloatArray, frames: Any) -> FloatArray:
    """Rows (N or 1, M) of ``rows`` (F or 1, M) at the given ``frames`` (N,); a single row is constant over
    all frames.
    """
    return rows if len(rows) == 1 else rows[frames]


LEAST_PROPORTION_FACTOR, MOST_PROPORTION_FACTOR = 0.2, 5.0


@dataclass(frozen=True)
class Proportions:
    """Factors on the measures of a build; all are 1 for the build itself. The inspector sets them by sliders."""

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
