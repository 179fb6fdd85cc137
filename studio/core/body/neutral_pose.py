"""Neutral pose of a skeleton, estimated from all frames of a take whose zero pose is not human.

The mean pose, in which upright frames weigh most, is straightened: trunk and legs vertical, hips and shoulders square,
wrists straight. The head is an exception, because a fighter looks over a shoulder through a whole take: it takes the
axes of its joint that are nearest to the mean, since programs whose zero pose is not human align the axes with the
bones.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from studio.core.body.hand_end import hand_reach, has_hand_length
from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.rotations import from_matrix, multiply, normalized, shortest_arc, to_matrix

FloatArray = NDArray[np.float64]

_UP: FloatArray = np.array([0.0, 0.0, 1.0])
_LEFT: FloatArray = np.array([0.0, 1.0, 0.0])
_FRAMES = 2048
"""Frames, spread over the take, that are averaged."""
_HEAD_TILT, _HEAD_TURN, _BONE_ASIDE = 15.0, 40.0, 4.0
"""Standard deviations in degrees: of a take's mean head from level, from the shoulders' front; of its bone from the
middle plane."""
_SURE, _LEAST_DOUBT = 2.0, 10.0
"""Difference of unlikeliness from which the second best is ruled out; degrees of doubt that remain even then."""
_ODD_BONE = 6.0
"""Most that a head's bone counts: ends of bones are placeholders in some files."""
_MOST_TILT = 40.0
"""Degrees from the mean beyond which no axis of the head's joint is its vertical."""
_NECK_SHARE = 0.6
"""Part of a head's turn about the vertical that the joint of its neck carries."""
_NEAR_AXIS, _MOST_EDGED = np.radians(12.0), np.radians(40.0)
"""Radians within which the sole of one foot, and that of the other, are level with the axes of their joints."""
_LOWEST = 15.0
"""Percent of the frames in which a foot is lowest, and stands."""
_ALONG_AXIS, _MOST_TWIST = np.radians(3.0), np.radians(60.0)
"""Radians within which a forearm lies along an axis of its joint; most by which a take keeps it twisted."""
_ANKLE_OVER_BALL = 0.078
"""Height of the ankle of a flat foot over the joint of its toes, in parts of the leg's length."""
_SHORTEST_ACROSS = 0.01
"""Metres between two shoulders from which they have a direction."""


@dataclass(frozen=True)
class NeutralPose:
    """Neutral pose: local ``rotations`` (J, 4) of a body upright along Z that faces +X, and the uncertainty of its
    head.
    """

    rotations: FloatArray
    head_doubt: float
    """Angle in degrees by which the head may be wrongly turned."""


def find_neutral_pose(skeleton: Skeleton, poses: PoseSequence, body_map: BodyMap, weights: FloatArray) -> NeutralPose:
    """Neutral pose of ``skeleton``, estimated from all frames of ``poses``; ``weights`` (F,) are greater for upright
    frames.
    """
    seen = slice(None, None, max(1, poses.frame_count // _FRAMES))
    sample = PoseSequence(poses.local_rotations[seen], poses.local_translations[seen])
    positions, turns = joint_world(skeleton, sample)
    shares = weights[seen] / weights[seen].sum()
    pose = _Pose(skeleton, body_map, _mean_rotations(sample.local_rotations, shares))
    pose.place_root(turns, positions, shares)
    pose.stand()
    pose.untwist_forearms()
    pose.straighten_wrists()
    pose.level_feet({side: _standing_up(turns, positions, body_map, side, shares) for side in ("LEFT", "RIGHT")})
    doubt = 0.0
    if BodyPart.HEAD in body_map.parts:
        doubt = pose.face_forward(_head_axes(turns, positions, body_map, shares))
    return NeutralPose(pose.rotations, doubt)


class _Pose:
    """Pose with local ``rotations`` (J, 4) whose joints are rotated one by one towards a standing human."""

    def __init__(self, skeleton: Skeleton, body_map: BodyMap, rotations: FloatArray) -> None:
        self.skeleton, self.body_map, self.rotations = skeleton, body_map, rotations

    def place_root(self, turns: FloatArray, positions: FloatArray, shares: FloatArray) -> None:
        """Rotate the root to its mean orientation relative to a body that faces +X in every frame; ``turns`` (F, J, 3,
        3).
        """
        left = normalized(self._pair(positions, "THIGH") * [1.0, 1.0, 0.0])
        left = np.where(np.linalg.norm(left, axis=1, keepdims=True) > 0.5, left, [0.0, 1.0, 0.0])  # hips in one place
        headings = np.stack([np.cross(left, _UP), left, np.broadcast_to(_UP, left.shape)], axis=1)
        pelvis = self.body_map.spine[0]
        mean = _mean_rotations(from_matrix(headings @ turns[:, pelvis])[:, None], shares)[0]
        self._turn(pelvis, to_matrix(mean) @ self._world()[1][pelvis].T)

    def stand(self) -> None:
        """Rotate trunk and legs to the vertical, and hips and shoulders square to the front."""
        body_map, spine = self.body_map, self.body_map.spine
        points = self._world()[0]
        trunk = self._middle(points, "UPPER_ARM") - self._middle(points, "THIGH")
        self._turn(spine[0], shortest_arc(normalized(trunk), _UP))
        self._square(spine[0], "THIGH")
        base = "CLAVICLE" if self._across("CLAVICLE") is not None else "UPPER_ARM"
        self._square(spine[-1], base)
        for side, (upper, lower) in product(("LEFT", "RIGHT"), (("THIGH", "SHANK"), ("SHANK", "FOOT"))):
            joint, end = body_map[BodyPart[f"{side}_{upper}"]], body_map[BodyPart[f"{side}_{lower}"]]
            points = self._world()[0]
            self._turn(joint, shortest_arc(normalized(points[end] - points[joint]), -_UP))

    def untwist_forearms(self) -> None:
        """Twist both forearms to the nearest quarter turn from the upper arms, mirror-symmetrically.

        Only bones along an axis of their joint are twisted; the axes of other joints show no twist.
        """
        elbows = [self._joint(side, "FOREARM") for side in ("LEFT", "RIGHT")]
        wrists = [self._joint(side, "HAND") for side in ("LEFT", "RIGHT")]
        bones = normalized(self.skeleton.offsets[wrists])
        if np.abs(bones).max(axis=1).min() < np.cos(_ALONG_AXIS):
            return
        vectors, scalars = self.rotations[elbows, :3], self.rotations[elbows, 3]
        twists = 2.0 * np.arctan2(np.sum(vectors * bones, axis=1), scalars)
        quarters = np.arange(4)[:, None] * [0.5 * np.pi, -0.5 * np.pi]
        beyond = (twists - quarters + np.pi) % (2.0 * np.pi) - np.pi
        nearest = beyond[int(np.argmin((beyond**2).sum(axis=1)))]
        if np.abs(nearest).max() < _MOST_TWIST:
            for elbow, bone, twist in zip(elbows, bones, nearest, strict=True):
                self._turn(elbow, _about(self._world()[1][elbow] @ bone, -float(twist)))

    def level_feet(self, ups: Mapping[str, FloatArray]) -> None:
        """Roll each foot about its length until its sole is level, then pitch it until its bone has the slope of a flat
        human foot.

        ``ups`` (3,) are normals of the soles of standing feet by side, in the axes of their joints. Soles are level
        where the lateral axes of the joints are, if that is nearly true of one foot: the other one may be a fighter's
        that never stands flat.
        """
        sides = [side for side in ups if self._front(side).any()]
        for side in sides:
            normal = self._world()[1][self._joint(side, "FOOT")] @ ups[side]
            if normal[2] > np.cos(_MOST_EDGED):  # a body that lies or crawls stands on no sole
                self._roll_foot(side, float(np.arctan2(normal @ np.cross(_UP, self._front(side)), normal[2])))
        rolls = {side: self._axis_roll(side) for side in sides}
        apart = [abs(roll) for roll in rolls.values()] or [0.0]
        near = min(apart) < _NEAR_AXIS and max(apart) < _MOST_EDGED
        for side in sides:
            if near:
                self._roll_foot(side, -rolls[side])
            foot, toe = (self._world()[0][self._joint(side, part)] for part in ("FOOT", "TOE"))
            slope = float(np.arcsin((foot - toe)[2] / np.linalg.norm(toe - foot)))
            left = np.cross(_UP, self._front(side))
            self._turn(self._joint(side, "FOOT"), _about(left, self._flat_slope(side) - slope))

    def _front(self, side: str) -> FloatArray:
        """Horizontal direction (3,) of a foot; zero if it has no toe or points down."""
        if BodyPart[f"{side}_TOE"] not in self.body_map.parts:
            return np.zeros(3)
        points = self._world()[0]
        along = (points[self._joint(side, "TOE")] - points[self._joint(side, "FOOT")]) * [1.0, 1.0, 0.0]
        return normalized(along) if np.linalg.norm(along) >= _SHORTEST_ACROSS else np.zeros(3)

    def _roll_foot(self, side: str, angle: float) -> None:
        self._turn(self._joint(side, "FOOT"), _about(self._front(side), angle))

    def _axis_roll(self, side: str) -> float:
        """Radians by which the lateral axis of a foot's joint is rolled about the foot's length."""
        left = np.cross(_UP, self._front(side))
        turn = self._world()[1][self._joint(side, "FOOT")]
        axes = turn * np.sign(left @ turn)
        nearest = axes[:, int(np.argmax(left @ axes))]
        return float(np.arctan2(nearest[2], left @ nearest))

    def _flat_slope(self, side: str) -> float:
        """Slope in radians of the bone from the ankle down to the toe joint of a flat foot."""
        hip, knee, ankle, toe = (
            self._world()[0][self._joint(side, part)] for part in ("THIGH", "SHANK", "FOOT", "TOE")
        )
        leg = float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))
        return float(np.arcsin(min(_ANKLE_OVER_BALL * leg / float(np.linalg.norm(toe - ankle)), 0.9)))

    def straighten_wrists(self) -> None:
        """Align each hand that has a bone with its forearm."""
        for side in ("LEFT", "RIGHT"):
            elbow, wrist = (self.body_map[BodyPart[f"{side}_{part}"]] for part in ("FOREARM", "HAND"))
            points = self._world()[0]
            along = points[wrist] - points[elbow]
            reach = hand_reach(self.skeleton, wrist, points[None])
            if has_hand_length(reach, along[None])[0]:
                self._turn(wrist, shortest_arc(normalized(reach[0]), normalized(along)))

    def face_forward(self, mean_axes: FloatArray) -> float:
        """Align the head's own axes, found from its ``mean_axes``, with the world's; return the uncertainty in degrees.

        The neck, which takes a part of each rotation of the head, is rotated about the vertical with it.
        """
        head, neck = self.body_map[BodyPart.HEAD], self.body_map.get(BodyPart.NECK)
        over_trunk = self._world()[1][head].T[:, 2]
        axes, doubt = _own_axes(mean_axes, over_trunk, self._head_bone(head))
        if neck is not None:
            _, _, z, w = from_matrix(axes.T @ self._world()[1][head].T)
            half = _NECK_SHARE * np.arctan2(z, w)
            self._turn(neck, to_matrix(np.array([0.0, 0.0, np.sin(half), np.cos(half)])))
        self._turn(head, axes.T @ self._world()[1][head].T)
        return doubt

    def _head_bone(self, head: int) -> FloatArray:
        """(3,) direction of the longest bone below the head, in the head's axes; zero without one."""
        offsets = self.skeleton.offsets[list(self.skeleton.children[head])]
        longest = max(offsets, key=np.linalg.norm, default=np.zeros(3))
        return np.asarray(longest / max(float(np.linalg.norm(longest)), 1e-9))

    def _world(self) -> tuple[FloatArray, FloatArray]:
        positions, turns = joint_world(self.skeleton, rest_poses(self.skeleton, self.rotations))
        return positions[0], turns[0]

    def _turn(self, joint: int, turn: FloatArray) -> None:
        """Rotate a joint and its descendants by ``turn`` (3, 3) in the world."""
        parent = self.skeleton.parents[joint]
        carrier = self._world()[1][parent] if parent >= 0 else np.eye(3)
        self.rotations[joint] = multiply(from_matrix(carrier.T @ turn @ carrier), self.rotations[joint])

    def _square(self, joint: int, part: str) -> None:
        """Rotate ``joint`` about the vertical until the pair of ``part`` is aligned with +Y."""
        across = self._across(part)
        if across is not None:
            self._turn(joint, shortest_arc(across, _LEFT))

    def _across(self, part: str) -> FloatArray | None:
        """Horizontal direction (3,) from the right to the left joint of ``part``; None if there is no such pair."""
        if BodyPart[f"LEFT_{part}"] not in self.body_map.parts or BodyPart[f"RIGHT_{part}"] not in self.body_map.parts:
            return None
        across = self._pair(self._world()[0], part) * [1.0, 1.0, 0.0]
        return None if np.linalg.norm(across) < _SHORTEST_ACROSS else normalized(across)

    def _pair(self, points: FloatArray, part: str) -> FloatArray:
        return np.asarray(points[..., self._joint("LEFT", part), :] - points[..., self._joint("RIGHT", part), :])

    def _middle(self, points: FloatArray, part: str) -> FloatArray:
        return np.asarray(0.5 * (points[self._joint("LEFT", part)] + points[self._joint("RIGHT", part)]))

    def _joint(self, side: str, part: str) -> int:
        return self.body_map[BodyPart[f"{side}_{part}"]]


def _standing_up(
    turns: FloatArray, positions: FloatArray, body_map: BodyMap, side: str, shares: FloatArray
) -> FloatArray:
    """Mean vertical (3,) in the axes of a foot's joint, over the frames in which foot and toe are lowest."""
    foot = body_map[BodyPart[f"{side}_FOOT"]]
    heights = positions[:, [foot, body_map.parts.get(BodyPart[f"{side}_TOE"], foot)], 2].sum(axis=1)
    lowest = heights <= np.percentile(heights, _LOWEST)
    return normalized((shares * lowest) @ turns[:, foot, 2])


def _about(axis: FloatArray, angle: float) -> FloatArray:
    """Rotation (3, 3) about a unit ``axis`` (3,) by ``angle`` radians."""
    return to_matrix(np.array([*(np.sin(0.5 * angle) * axis), np.cos(0.5 * angle)]))


def _mean_rotations(rotations: FloatArray, shares: FloatArray) -> FloatArray:
    """Mean (J, 4) of quaternions (F, J, 4), weighted by ``shares`` (F,): Markley's largest eigenvector."""
    scatter = np.einsum("f,fja,fjb->jab", shares, rotations, rotations)
    return np.ascontiguousarray(np.linalg.eigh(scatter)[1][:, :, -1])


def _head_axes(turns: FloatArray, positions: FloatArray, body_map: BodyMap, shares: FloatArray) -> FloatArray:
    """(3, 3) mean front, left and up axes of the head as columns, in the axes of its joint."""
    head = turns[:, body_map[BodyPart.HEAD]]
    shoulders = positions[:, body_map[BodyPart.LEFT_UPPER_ARM]] - positions[:, body_map[BodyPart.RIGHT_UPPER_ARM]]
    up = normalized(shares @ head[:, 2])
    left = np.einsum("f,fji,fj->i", shares, head, normalized(shoulders * [1.0, 1.0, 0.0]))
    left = normalized(left - left @ up * up)
    return np.stack([np.cross(left, up), left, up], axis=1)


def _own_axes(mean: FloatArray, over_trunk: FloatArray, bone: FloatArray) -> tuple[FloatArray, float]:
    """Most likely front, left and up axes (3, 3) of a head with the given ``mean`` axes, and the uncertainty in
    degrees.

    Among the signed axes of the joint, those near the mean that keep the head's ``bone`` (3,) upright in the median
    plane win. ``over_trunk`` (3,) is the up axis if the trunk were upright, because the head of a body that leans far
    may be level or hang. If no axis is near either, the mean itself is taken.
    """
    candidates = _signed_axes()
    costs = [_unlikeliness(axes, mean, over_trunk, bone) for axes in candidates]
    first, second = np.argsort(costs)[:2]
    likeliest = candidates[first]
    if min(_degrees(likeliest[:, 2], up) for up in (mean[:, 2], over_trunk)) > _MOST_TILT:
        return mean, _HEAD_TURN
    sure = costs[second] - costs[first] > _SURE
    return likeliest, _LEAST_DOUBT if sure else _degrees(likeliest[:, 0], candidates[second][:, 0])


def _unlikeliness(axes: FloatArray, mean: FloatArray, over_trunk: FloatArray, bone: FloatArray) -> float:
    """Sum of squared deviations, in standard deviations, of head ``axes`` (3, 3) from the observed ones."""
    left, up = axes[:, 1], axes[:, 2]
    tilt = min(_degrees(up, mean[:, 2]), _degrees(up, over_trunk))
    turned = shortest_arc(mean[:, 2], up) @ mean[:, 1]
    cost = (tilt / _HEAD_TILT) ** 2 + (_degrees(left, turned) / _HEAD_TURN) ** 2
    if bone.any():
        cost += min((_degrees(bone, up) / _HEAD_TILT) ** 2, _ODD_BONE)
    if _degrees(bone, up) < _MOST_TILT:
        cost += ((_degrees(bone, left) - 90.0) / _BONE_ASIDE) ** 2
    return cost


def _signed_axes() -> list[FloatArray]:
    """All 24 right-handed frames made of the positive and negative coordinate axes."""
    frames = [
        np.eye(3)[list(order)].T * signs for order in permutations(range(3)) for signs in product((1.0, -1.0), repeat=3)
    ]
    return [frame for frame in frames if np.linalg.det(frame) > 0.0]


def _degrees(first: FloatArray, second: FloatArray) -> float:
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second)))
