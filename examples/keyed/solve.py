"""From keyed targets to poses: the trunk by its turns, the limbs by the studio's analytic two-bone kernel."""

import numpy as np
from scipy.ndimage import convolve1d, maximum_filter1d
from scipy.spatial.transform import Rotation

from studio.core.body.pose import PoseSequence
from studio.core.kernels.limbs.limb import place_limb
from studio.core.kernels.records import LimbShape, Pose
from studio.core.rotations import from_matrix

from .curves import FloatArray
from .performer import BODY, HEAD, LAYOUT, NECK, OUTWARD, THORAX, clavicle, make_skeleton, t_pose, thigh
from .targets import AirLeg, ArmTargets, Targets

_STRAIGHTEST_LEG, _STRAIGHTEST_ARM = 0.993, 0.99
"""Reach of a limb as a share of its length: nobody locks a knee or an elbow."""
_SPINE_SHARES = np.linspace(0.0, 1.0, LAYOUT.spine_count) ** 0.9
_NECK_SHARE = 0.4
_OVERTURNED = np.radians(75.0)
_SINKING = 0.12
"""Seconds before and after a far step over which the pelvis sinks for it."""


def solve(targets: Targets) -> PoseSequence:
    """The performer's poses, joint by joint as ``performer.make_skeleton`` has them."""
    body = _Body(targets)
    body.turn_trunk()
    body.sink_pelvis()
    for side in (0, 1):
        body.place_leg(side)
        body.place_arm(side)
    return body.poses()


def euler(turn: FloatArray) -> Rotation:
    """Rotations of yaw, pitch, roll (F, 3) in degrees: roll first, then pitch, then yaw."""
    return Rotation.from_euler("ZYX", turn, degrees=True)


class _Body:
    """World rotations (F, S, 3, 3) of all segments while they are being found."""

    def __init__(self, targets: Targets) -> None:
        self.targets = targets
        self.root = np.array(targets.pelvis, dtype=np.float64)
        self.world = np.tile(np.eye(3), (len(targets.times), LAYOUT.segment_count, 1, 1))

    def turn_trunk(self) -> None:
        """Pelvis, spine in equal bends, neck between chest and head."""
        pelvis = euler(self.targets.pelvis_turn)
        bend = euler(self.targets.chest_turn).as_rotvec()
        for segment, share in enumerate(_SPINE_SHARES):
            self.world[:, segment] = (pelvis * Rotation.from_rotvec(bend * share)).as_matrix()
        chest, head = Rotation.from_matrix(self.world[:, THORAX]), euler(self.targets.head_turn)
        between = Rotation.from_rotvec((chest.inv() * head).as_rotvec() * _NECK_SHARE)
        self.world[:, NECK], self.world[:, HEAD] = (chest * between).as_matrix(), head.as_matrix()

    def hip(self, side: int) -> FloatArray:
        return self.root + self.world[:, 0] @ BODY.hip_offset[side]

    def sink_pelvis(self) -> None:
        """Lower the root where a planted leg or arm would not reach: widest need nearby, evened out (METHOD 5)."""
        need = np.zeros(len(self.root))
        for side, foot in enumerate(self.targets.feet):
            away = foot.ankle - self.hip(side)
            length = _STRAIGHTEST_LEG * BODY.leg[side].sum()
            highest = foot.ankle[:, 2] + np.sqrt(np.maximum(length**2 - away[:, 0] ** 2 - away[:, 1] ** 2, 0))
            standing = 1 - self.targets.air[side].share if side in self.targets.air else 1.0
            need = np.maximum(need, (self.hip(side)[:, 2] - highest) * standing)
        for side, arm in enumerate(self.targets.arms):
            if arm.carries and arm.held is not None and arm.holding is not None:
                shoulder, _ = self._raise_shoulder(side, self._arm_axes(arm))
                away = arm.held - shoulder
                length = _STRAIGHTEST_ARM * BODY.arm[side].sum()
                highest = arm.held[:, 2] + np.sqrt(np.maximum(length**2 - away[:, 0] ** 2 - away[:, 1] ** 2, 0))
                need = np.maximum(need, (shoulder[:, 2] - highest) * arm.holding)
        frames = 2 * round(_SINKING * self.targets.frame_rate) + 1
        window = np.hanning(frames + 2)[1:-1]
        widest = maximum_filter1d(need, frames, mode="nearest")
        self.root[:, 2] -= convolve1d(widest, window / window.sum(), mode="nearest")

    def place_leg(self, side: int) -> None:
        foot, segment = self.targets.feet[side], thigh(side)
        ankle, turn = foot.ankle, euler(np.stack([foot.yaw, foot.pitch, 0 * foot.yaw], axis=1))
        toe = foot.toe
        if side in self.targets.air:
            ankle, turn, toe = self._air(side, self.targets.air[side], ankle, turn, toe)
        left = self.world[:, 0, :, 1]
        yaw, _, roll = np.radians(self.targets.pelvis_turn).T
        overturned = np.abs(roll) > _OVERTURNED  # left points to the right then
        toes_out = np.radians(foot.yaw) - np.where(overturned, yaw, np.arctan2(-left[:, 0], left[:, 1]))
        following = 0.5 * np.arctan2(np.sin(toes_out), np.cos(toes_out))
        if side in self.targets.air:
            following *= 1 - self.targets.air[side].share
        splay = np.radians(self.targets.splay[side]) * OUTWARD[side]
        hinge = Rotation.from_rotvec(np.outer(following + splay, [0, 0, 1])).apply(left)
        self._limb(segment, self.hip(side), ankle, hinge, BODY.leg[side], 0.0)
        self.world[:, segment + 2] = turn.as_matrix()
        self.world[:, segment + 3] = (turn * _about("y", toe)).as_matrix()

    def _air(
        self, side: int, leg: AirLeg, ankle: FloatArray, turn: Rotation, toe: FloatArray
    ) -> tuple[FloatArray, Rotation, FloatArray]:
        """Ankle, foot turn and toes where a kick takes the leg over from the path of the foot."""
        outward = _about("z", leg.outward * OUTWARD[side])
        pelvis = Rotation.from_matrix(self.world[:, 0]) * outward
        down = np.array([0.0, 0.0, -1.0])
        upper = pelvis * _about("y", -leg.thigh)
        lower = pelvis * _about("y", leg.knee - leg.thigh)
        kicked = self.hip(side) + upper.apply(down) * BODY.leg[side][0] + lower.apply(down) * BODY.leg[side][1]
        foot = lower * _about("y", leg.foot)
        share = leg.share[:, None]
        between = Rotation.from_rotvec(_continuous((turn.inv() * foot).as_rotvec()) * share)
        return ankle + share * (kicked - ankle), turn * between, toe + leg.share * (leg.toe - toe)

    def place_arm(self, side: int) -> None:
        """Elbow where it is pointed to, then the hand."""
        arm, segment, outward = self.targets.arms[side], clavicle(side), OUTWARD[side]
        axes = self._arm_axes(arm)
        shoulder, wrist = self._raise_shoulder(side, axes)
        along = _within_reach(wrist - shoulder, BODY.arm[side].sum())
        hinge = np.cross(axes.apply(arm.elbow), along)
        half_twist = 0.5 * outward * np.asarray(arm.pronation)  # the forearm takes one half, the wrist the other
        self._limb(segment + 1, shoulder, shoulder + along, hinge, BODY.arm[side], np.radians(half_twist))
        hand = np.broadcast_arrays(half_twist, outward * arm.flexion, arm.deviation, along[:, 0])[:3]
        self.world[:, segment + 3] = self.world[:, segment + 2] @ euler(np.stack(hand, axis=1)).as_matrix()

    def _raise_shoulder(self, side: int, axes: Rotation) -> tuple[FloatArray, FloatArray]:
        """Turn the clavicle as far as the reach of the arm asks; the shoulder and the wrist's goal (F, 3)."""
        arm, segment, outward = self.targets.arms[side], clavicle(side), OUTWARD[side]
        chest, bone = self.world[:, THORAX], t_pose()[segment]
        collar = self._neck_base() + chest @ BODY.collar_base[side]
        resting = collar + chest @ bone[:, 2] * BODY.clavicle[side]
        wrist = resting + axes.apply(arm.wrist)
        if arm.held is not None and arm.holding is not None:
            wrist += arm.holding[:, None] * (arm.held - wrist)
        ahead, _, up = (np.einsum("fji,fj->fi", chest, wrist - resting) / BODY.arm[side].sum()).T
        forward = arm.thrust + 14 * np.maximum(ahead - 0.2, 0) - 6 * np.maximum(-ahead, 0)
        upward = arm.shrug + 22 * np.maximum(up + 0.45, 0)
        girdle = euler(np.stack([-outward * forward, 0 * forward, outward * upward], axis=1))
        self.world[:, segment] = chest @ girdle.as_matrix() @ bone
        return collar + self.world[:, segment, :, 2] * BODY.clavicle[side], wrist

    def _neck_base(self) -> FloatArray:
        spine = np.einsum("fsij,sj->fi", self.world[:, : LAYOUT.spine_count], BODY.spine)
        return np.asarray(self.root + spine)

    def _arm_axes(self, arm: ArmTargets) -> Rotation:
        chest = Rotation.from_matrix(self.world[:, THORAX])
        forward = self.world[:, THORAX, :, 0]
        heading = Rotation.from_rotvec(np.outer(np.arctan2(forward[:, 1], forward[:, 0]), [0, 0, 1]))
        rising = (chest.inv() * heading).as_rotvec() * np.reshape(arm.upright, (-1, 1))
        return chest * Rotation.from_rotvec(rising)

    def _limb(
        self,
        segment: int,
        start: FloatArray,
        end: FloatArray,
        hinge: FloatArray,
        lengths: FloatArray,
        twist: float | FloatArray,
    ) -> None:
        """Upper and lower segment of a limb that bends about ``hinge`` (F, 3), by ``place_limb``."""
        along = end - start
        distance = np.linalg.norm(along, axis=1)
        z = along / distance[:, None]
        x = hinge - np.sum(hinge * z, axis=1, keepdims=True) * z
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        frames = np.stack([x, np.cross(z, x), z], axis=2)
        lower_twist = np.broadcast_to(twist, distance.shape)
        for frame in range(len(distance)):
            limb = LimbShape(tuple(lengths), distance[frame], 0.0, 1.0, (0.0, lower_twist[frame]))
            pose = Pose(np.stack([start[frame]] * 3), self.world[frame])
            place_limb(0, segment, tuple(frames[frame].ravel()), limb, pose)

    def poses(self) -> PoseSequence:
        """Local rotations of all joints; the ends stay at rest."""
        parents = list(LAYOUT.parent_segments())
        joints = self.world @ np.swapaxes(t_pose(), -1, -2)
        local = np.swapaxes(joints[:, parents], -1, -2) @ joints
        local[:, 0] = joints[:, 0]
        skeleton = make_skeleton()
        rotations = np.zeros((len(local), skeleton.joint_count, 4))
        rotations[..., 3] = 1.0
        rotations[:, : len(parents)] = from_matrix(local)
        translations = np.tile(skeleton.offsets, (len(local), 1, 1))
        translations[:, 0] = self.root
        return PoseSequence(rotations, translations)


def _continuous(vectors: FloatArray) -> FloatArray:
    """Rotation vectors (F, 3) that go on beyond half a turn, and do not jump to the other way round."""
    found = np.array(vectors)
    for frame in range(1, len(found)):
        angle = np.linalg.norm(found[frame])
        other = found[frame] * (1.0 - 2.0 * np.pi / max(angle, 1e-9))
        if np.linalg.norm(other - found[frame - 1]) < np.linalg.norm(found[frame] - found[frame - 1]):
            found[frame] = other
    return found


def _about(axis: str, angles: FloatArray) -> Rotation:
    """Turns (F,) in degrees about one axis."""
    return Rotation.from_euler(axis, angles[:, None], degrees=True)


def _within_reach(along: FloatArray, length: float) -> FloatArray:
    """Vectors (F, 3) shortened softly, so that a limb of ``length`` never locks."""
    share = np.linalg.norm(along, axis=1, keepdims=True) / length
    start, room = 0.96, _STRAIGHTEST_ARM - 0.96
    soft = start + room * (1 - np.exp(-np.maximum(share - start, 0) / room))
    return along * np.where(share > start, soft / share, 1.0)
