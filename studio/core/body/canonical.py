"""The canonical body: the points and segments in which every motion and every character is expressed.

K spine segments (0 is the pelvis, K-1 the thorax) make K+18 segments and K+23 points, depth first, so that
everything distal to a segment is one contiguous range. Side 0 is left, 1 is right; limbs are left arm, right
arm, left leg, right leg.

Axes of the segments (columns of their world rotation):
  pelvis, spine, feet, toes   x forward, y left, z up in the reference pose
  neck, head, clavicle        z along the bone, x forward
  upper arm, thigh and below  z along the bone, x the hinge axis of elbow or knee
  hand                        as the forearm in the reference pose
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import cache

from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE, SEGMENTS_BESIDE_SPINE


class BodyPart(StrEnum):
    """Body segment, named independently of the number of vertebrae; all inner vertebrae are the abdomen."""

    PELVIS = "pelvis"
    ABDOMEN = "abdomen"
    THORAX = "thorax"
    NECK = "neck"
    HEAD = "head"
    LEFT_CLAVICLE = "left_clavicle"
    LEFT_UPPER_ARM = "left_upper_arm"
    LEFT_FOREARM = "left_forearm"
    LEFT_HAND = "left_hand"
    RIGHT_CLAVICLE = "right_clavicle"
    RIGHT_UPPER_ARM = "right_upper_arm"
    RIGHT_FOREARM = "right_forearm"
    RIGHT_HAND = "right_hand"
    LEFT_THIGH = "left_thigh"
    LEFT_SHANK = "left_shank"
    LEFT_FOOT = "left_foot"
    LEFT_TOE = "left_toe"
    RIGHT_THIGH = "right_thigh"
    RIGHT_SHANK = "right_shank"
    RIGHT_FOOT = "right_foot"
    RIGHT_TOE = "right_toe"

    @property
    def label(self) -> str:
        """Label for the user, such as ``Left upper arm``; ``Left lower leg`` for a shank and ``Chest`` for
        the thorax.
        """
        words = self.value.replace("_", " ").replace("shank", "lower leg").replace("thorax", "chest")
        return words.capitalize()


_AFTER_SPINE = tuple(part for part in BodyPart if part not in ("pelvis", "abdomen", "thorax"))


@dataclass(frozen=True)
class BodyLayout:
    """Indices of points and segments in the arrays of a body with ``spine_count`` spine segments."""

    spine_count: int

    def __post_init__(self) -> None:
        if self.spine_count < 2:
            raise ValueError(f"A spine needs a pelvis and a thorax: {self.spine_count} segment is too few.")

    @property
    def point_count(self) -> int:
        """Number of points, K + 23."""
        return self.spine_count + POINTS_BESIDE_SPINE

    @property
    def segment_count(self) -> int:
        """Number of segments, K + 18."""
        return self.spine_count + SEGMENTS_BESIDE_SPINE

    @property
    def neck_base(self) -> int:
        """Index of the point at the base of the neck."""
        return self.spine_count

    @property
    def head_joint(self) -> int:
        """Index of the point at the joint of the head."""
        return self.spine_count + 1

    @property
    def head_end(self) -> int:
        """Index of the point at the top of the head."""
        return self.spine_count + 2

    def collar_point(self, side: int) -> int:
        """Index of the point at the inner end of the clavicle; shoulder, elbow, wrist and hand end follow it."""
        return self.spine_count + 3 + 5 * side

    def hip_point(self, side: int) -> int:
        """Index of the hip's point on ``side`` (0 left, 1 right); knee, ankle, toe and toe end follow it."""
        return self.spine_count + 13 + 5 * side

    def ankle_point(self, side: int) -> int:
        """Index of the ankle's point on ``side`` (0 left, 1 right)."""
        return self.hip_point(side) + 2

    def toe_point(self, side: int) -> int:
        """Index of the toe joint's point on ``side`` (0 left, 1 right)."""
        return self.hip_point(side) + 3

    def wrist_point(self, side: int) -> int:
        """Index of the wrist's point on ``side`` (0 left, 1 right)."""
        return self.collar_point(side) + 3

    def clavicle_segment(self, side: int) -> int:
        """Index of the clavicle on ``side``; upper arm, forearm and hand follow it."""
        return self.spine_count + 2 + 4 * side

    def upper_arm_segment(self, side: int) -> int:
        return self.clavicle_segment(side) + 1

    def hand_segment(self, side: int) -> int:
        return self.clavicle_segment(side) + 3

    def thigh_segment(self, side: int) -> int:
        """Index of the thigh on ``side``; shank, foot and toes follow it."""
        return self.spine_count + 10 + 4 * side

    def foot_segment(self, side: int) -> int:
        return self.thigh_segment(side) + 2

    def toe_segment(self, side: int) -> int:
        return self.thigh_segment(side) + 3

    def segment_of_part(self, part: BodyPart) -> int:
        """Index of the segment of ``part``."""
        match part:
            case BodyPart.PELVIS:
                return 0
            case BodyPart.ABDOMEN:
                return self.spine_count // 2
            case BodyPart.THORAX:
                return self.spine_count - 1
        return self.spine_count + _AFTER_SPINE.index(part)

    def part_of_segment(self, segment: int) -> BodyPart:
        """Part to which a ``segment`` belongs; all inner vertebrae belong to the abdomen."""
        if segment >= self.spine_count:
            return _AFTER_SPINE[segment - self.spine_count]
        if segment == 0:
            return BodyPart.PELVIS
        return BodyPart.THORAX if segment == self.spine_count - 1 else BodyPart.ABDOMEN

    def proximal_points(self) -> tuple[int, ...]:
        """Index of the proximal point of each segment, about which it rotates."""
        return _proximal_points(self)

    def distal_points(self) -> tuple[int, ...]:
        """Index of the distal point of each segment."""
        return tuple(point + 1 for point in self.proximal_points())

    def parent_segments(self) -> tuple[int, ...]:
        """Index of the parent of each segment; -1 for the pelvis."""
        spine, thorax = self.spine_count, self.spine_count - 1
        parents = [*range(-1, thorax), thorax, spine]
        for first, carrier in ((2, thorax), (6, thorax), (10, 0), (14, 0)):
            parents += [carrier, spine + first, spine + first + 1, spine + first + 2]
        return tuple(parents)

    def point_names(self) -> tuple[str, ...]:
        """Readable name of each point."""
        arm, leg = (
            ("collar", "shoulder", "elbow", "wrist", "hand end"),
            ("hip", "knee", "ankle", "toe", "toe end"),
        )
        return (
            "root",
            *(f"spine {k}" for k in range(1, self.spine_count)),
            *("neck base", "head joint", "head end"),
            *(f"{side} {name}" for side in ("left", "right") for name in arm),
            *(f"{side} {name}" for side in ("left", "right") for name in leg),
        )


@cache
def _proximal_points(layout: BodyLayout) -> tuple[int, ...]:
    arms = tuple(layout.collar_point(side) + bone for side in (0, 1) for bone in range(4))
    legs = tuple(layout.hip_point(side) + bone for side in (0, 1) for bone in range(4))
    return (*range(layout.spine_count), layout.neck_base, layout.head_joint, *arms, *legs)
