"""Shape of a mannequin: smooth solids along the bones of its rest pose.

All numbers are fractions of stature (in the foot, of foot length) for an average man; the factors of the physique adapt
them. Only the left half is described, because the field is symmetric about y = 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import FloatArray
from studio.core.body.rest_pose import rest_pose
from studio.core.mannequin.field import BlendedSolid, Ellipsoid, Loft, Solid, smooth_union, union
from studio.core.mannequin.fingers import fingers
from studio.core.mannequin.physique import Physique
from studio.core.mannequin.surface import Triangles
from studio.core.rotations import frame_along

_FORWARD, _LEFT, _UP = np.eye(3)
_Parts = list[BlendedSolid]


@dataclass(frozen=True)
class Form:
    """Solids that make the body of one physique in its rest pose."""

    physique: Physique

    @cached_property
    def rest(self) -> tuple[FloatArray, FloatArray]:
        """Positions and rotations of the rest pose."""
        return rest_pose(self.physique.morphology())

    def point(self, name: str) -> FloatArray:
        """World position (3,) of a point of the left half, by its name in the layout without ``left``."""
        names = self.physique.morphology().layout.point_names()
        place: FloatArray = self.rest[0][names.index(name if name in names else f"left {name}")]
        return place

    def frame(self, part: BodyPart) -> FloatArray:
        """World rotation (3, 3) of the segment of ``part``."""
        rotation: FloatArray = self.rest[1][self.physique.morphology().layout.segment_of_part(part)]
        return rotation

    def distance(self, points: FloatArray) -> FloatArray:
        """Signed distances (N,) of world ``points`` (N, 3) from the surface of the whole body."""
        torso, neck, skull, arm, leg = self.regions(points)
        h = self.physique.stature
        head = smooth_union(neck, skull, 0.018 * h)
        body = smooth_union(smooth_union(torso, head, 0.032 * h), arm, 0.070 * h)
        return smooth_union(body, leg, 0.050 * h)

    def edge_lengths(self, points: FloatArray) -> FloatArray:
        """Desired edge lengths (N,) of the mesh at ``points``: short on hands, face and feet, and where a
        limb bends.
        """
        h = self.physique.stature
        half = points.copy()
        half[:, 1] = np.abs(half[:, 1])
        lengths = np.full(len(points), 0.0145)
        for centre, radius, length in self._details:
            distance = np.linalg.norm(half - centre, axis=1) / h
            lengths = np.minimum(lengths, length + 0.15 * np.maximum(distance - radius, 0))
        return lengths * h

    @cached_property
    def _details(self) -> list[tuple[FloatArray, float, float]]:
        """Regions of small triangles: centre, radius and edge length as fractions of stature."""
        p = self.physique
        hand = (self.point("wrist") + self.point("hand end")) / 2
        return [
            (hand, 0.45 * p.hand, 0.0058 * p.hand / 0.106),
            (self.point("toe") * [1, 1, 0], 0.45 * p.foot_length, 0.0090),
            (self.point("head joint") + _vector(0.02 * p.stature, 0, 0), 0.7 * p.head, 0.0085 * p.head / 0.088),
            (
                self.point("head joint") + _vector(0.062, 0.010, 0.006) * p.stature * p.head / 0.088,
                0.26 * p.head,
                0.0040 * p.head / 0.088,
            ),
            (self.point("elbow"), 0.03, 0.0095),
            (self.point("knee"), 0.04, 0.0115),
            (self.point("ankle") + _vector(0, 0, 0.03 * p.stature), 0.04, 0.0095),
            (self.point("shoulder"), 0.03, 0.0120),
        ]

    def regions(self, points: FloatArray) -> tuple[FloatArray, ...]:
        """Signed distances from torso, neck, skull, arm and leg; for arm and leg, from the nearer of left and right."""
        half = points.copy()
        half[:, 1] = np.abs(half[:, 1])
        leg = union(self._leg, half)
        above_sole = -smooth_union(-leg, half[:, 2], 0.012 * self.physique.stature)
        return (
            *(union(parts, half) for parts in (self._torso, self._neck, self._skull, self._arm)),
            above_sole,
        )

    @cached_property
    def _torso(self) -> _Parts:
        p, h = self.physique, self.physique.stature
        hip, top = self.point("hip")[2] / h, self.point("neck base")[2] / h
        wide = p.shoulder_width / 0.218
        rows = [
            (-0.13, -0.002, 0.024, 0.022 * p.hips),
            (-0.06, -0.002, 0.043 * p.seat, 0.050 * p.hips),
            (0.03, -0.002, 0.056 * p.seat, 0.074 * p.hips),
            (0.14, 0.000, 0.056 * (p.seat + p.waist) / 2, 0.078 * (p.hips + p.waist) / 2),
            (0.35, 0.003, 0.054 * p.waist, 0.075 * p.waist),
            (0.48, 0.003, 0.058 * (p.waist + p.chest_depth) / 2, 0.081 * (p.waist + p.chest) / 2),
            (0.62, 0.000, 0.062 * p.chest_depth, 0.092 * p.chest),
            (0.73, -0.004, 0.060 * p.chest_depth, 0.101 * (p.chest + wide) / 2),
            (0.81, -0.009, 0.052 * p.chest_depth, 0.096 * wide),
            (0.89, -0.016, 0.041 * p.chest_depth, 0.078 * wide),
            (0.96, -0.021, 0.031 * p.neck_girth, 0.042 * wide),
            (1.02, -0.021, 0.026 * p.neck_girth, 0.032 * p.neck_girth),
        ]
        stations = np.array([(hip + (top - hip) * t, x, 0, depth, breadth) for t, x, depth, breadth in rows]) * h
        trunk = Loft(np.zeros(3), np.eye(3), stations, power=2.25, caps=(0.012 * h, 0.02 * h))

        def blob(t: float, x: float, y: float, radii: tuple[float, float, float], fillet: float) -> BlendedSolid:
            centre = np.array([x, y, hip + (top - hip) * t]) * h
            return BlendedSolid(Ellipsoid(centre, np.array(radii) * h, np.eye(3)), fillet * h)

        parts = [BlendedSolid(trunk)]
        seat = 0.046 * p.seat
        parts.append(blob(0.00, -0.028 * p.seat, 0.041 * p.hips, (seat, 0.043 * p.hips, 0.052), 0.06))
        if p.pectorals:
            swell = (0.024 * p.pectorals, 0.050 * wide, 0.034)
            parts.append(blob(0.69, 0.034 * p.chest_depth, 0.042 * wide, swell, 0.07))
        if p.bust:
            swell = (0.036 * p.bust, 0.036 * p.bust, 0.035 * p.bust)
            parts.append(blob(0.60, 0.042 * p.chest_depth, 0.042, swell, 0.055))
        if p.belly:
            parts.append(blob(0.27, 0.010 + 0.02 * p.belly, 0.0, (0.062 * p.belly, 0.080 * p.belly, 0.085), 0.08))
        shoulder, neck = self.point("shoulder"), self.point("neck base")
        inner, outer = (
            neck + _vector(-0.006 * h, 0.012 * h, 0.004 * h),
            shoulder + _vector(-0.006 * h, -0.014 * h, -0.003 * h),
        )
        parts.append(BlendedSolid(_cone(inner, outer, 0.021 * h * p.neck_girth, 0.020 * h * p.shoulders), 0.05 * h))
        return parts

    @cached_property
    def _neck(self) -> _Parts:
        p, h = self.physique, self.physique.stature
        girth = 0.0312 * h * p.neck_girth
        low = self.point("neck base") + _vector(-0.004 * h, 0, -0.020 * h)
        high = self.point("head joint") + _vector(0.008 * h, 0, 0.014 * h)
        length = float(np.linalg.norm(high - low))
        rows = [(0.00, 1.12, 1.12), (0.35, 0.97, 0.92), (0.62, 0.92, 0.84), (0.85, 0.96, 0.82), (1.00, 0.98, 0.84)]
        stations = np.array([(along * length, 0.0, 0.0, deep * girth, wide * girth) for along, deep, wide in rows])
        frame = frame_along(high - low, _FORWARD)
        return [BlendedSolid(Loft(low, frame, stations))]

    @cached_property
    def _skull(self) -> _Parts:
        p = self.physique
        u = p.stature * p.head / 0.088
        joint, s, j = self.point("head joint"), p.skull, p.jaw

        def blob(x: float, y: float, z: float, *radii: float, tilt: float = 0.0, fillet: float = 0.0) -> BlendedSolid:
            c, d = np.cos(tilt), np.sin(tilt)
            frame = np.array([[c, 0, d], [0, 1, 0], [-d, 0, c]])
            return BlendedSolid(Ellipsoid(joint + _vector(x, y, z) * u, np.array(radii) * u, frame), fillet * u)

        bridge, tip = (
            joint + _vector(x, 0, z) * u for x, z in ((0.0570, 0.027), (0.0645 + 0.0045 * j, -0.001 + 0.002 * (1 - j)))
        )
        return [
            blob(0.009, 0, 0.036, 0.056 * s, 0.045 * s, 0.052),
            blob(0.030, 0, 0.000, 0.033, 0.033 * s, 0.046, tilt=0.15, fillet=0.04),
            blob(0.022, 0.0245 * s, -0.016, 0.025, 0.0085, 0.0110 * j, tilt=0.40, fillet=0.030),
            blob(0.0505, 0, -0.0325, 0.0130 * j, 0.0140 * j, 0.0105, fillet=0.030),
            blob(0.0435, 0.0265 * s, 0.003, 0.0095, 0.0085, 0.0085, fillet=0.024),
            blob(0.0505 + 0.0012 * j, 0.014, 0.0345, 0.009, 0.019, 0.0060, fillet=0.018),
            replace(blob(0.0735, 0.0180, 0.0205, 0.0155, 0.0130, 0.0095, fillet=0.016), carved=True),
            BlendedSolid(_cone(bridge, tip, 0.0048 * u, 0.0072 * u), 0.010 * u),
            blob(0.0620 + 0.0035 * j, 0.0063, -0.0030, 0.0062, 0.0042, 0.0042, fillet=0.006),
            blob(0.0580, 0, -0.0165, 0.0060, 0.0120, 0.0062, fillet=0.014),
            blob(0.000, 0.0445 * s, 0.012, 0.0105, 0.0045, 0.0165, tilt=-0.2, fillet=0.006),
        ]

    @cached_property
    def _arm(self) -> _Parts:
        p, h = self.physique, self.physique.stature
        a, f = p.arms, p.forearms
        shoulder, elbow, wrist = self.point("shoulder"), self.point("elbow"), self.point("wrist")
        upper_rows = [
            (0.02, 0.0, 0.0, 0.026 * a, 0.028 * a),
            (0.20, -0.002, 0.000, 0.0295 * a, 0.031 * a),
            (0.50, 0.000, -0.001, 0.0270 * a, 0.0295 * a),
            (0.80, 0.000, 0.000, 0.0225 * a, 0.0235 * a),
            (1.00, 0.000, 0.001, 0.0220 * a, 0.0215 * a),
        ]
        lower_rows = [
            (0.00, 0.000, 0.001, 0.0220 * a, 0.0215 * a),
            (0.22, 0.000, -0.001, 0.0245 * f, 0.0250 * f),
            (0.50, 0.000, 0.000, 0.0205 * f, 0.0215 * f),
            (0.80, 0.000, 0.000, 0.0145 * f, 0.0165 * f),
            (1.00, 0.000, 0.000, 0.0125 * f, 0.0160 * f),
        ]
        upper = _limb(shoulder, self.frame(BodyPart.LEFT_UPPER_ARM), upper_rows, p.upper_arm * h, h)
        lower = _limb(elbow, self.frame(BodyPart.LEFT_FOREARM), lower_rows, p.forearm * h, h)
        arm_frame = self.frame(BodyPart.LEFT_UPPER_ARM)
        radii = np.array([0.030, 0.028, 0.044]) * h * p.shoulders
        deltoid = Ellipsoid(shoulder + arm_frame[:, 2] * 0.014 * h - _UP * 0.004 * h, radii, arm_frame)
        return [
            BlendedSolid(deltoid),
            BlendedSolid(upper, 0.04 * h),
            BlendedSolid(lower, 0.004 * h),
            *self._hand(wrist),
        ]

    def _hand(self, wrist: FloatArray) -> _Parts:
        p = self.physique
        u, g = p.stature * p.hand, p.hand_girth
        frame = self.frame(BodyPart.LEFT_HAND)
        palm_rows = [
            (-0.06, 0.000, 0.000, 0.118 * g, 0.150 * g),
            (0.16, 0.000, -0.010, 0.112 * g, 0.180 * g),
            (0.38, 0.000, -0.004, 0.098 * g, 0.205 * g),
            (0.52, 0.010, 0.000, 0.074 * g, 0.192 * g),
        ]
        palm = Loft(wrist, frame, np.array(palm_rows) * u, power=2.3, caps=(0.05 * u, 0.05 * u))
        root, knuckle = (
            wrist + frame @ (_vector(*place) * u) for place in ((0.03, -0.10 * g, 0.12), (0.08, -0.180 * g, 0.27))
        )
        return [
            BlendedSolid(palm, 0.03 * u),
            BlendedSolid(_cone(root, knuckle, 0.100 * u * g, 0.078 * u * g), 0.12 * u),
        ]

    def fingers(self, grip: float = 0.0) -> tuple[FloatArray, Triangles]:
        """Vertices and triangles of the left hand's thumb and fingers."""
        p = self.physique
        vertices, triangles = fingers(p.hand_girth, grip)
        return self.point("wrist") + vertices * p.stature * p.hand @ self.frame(BodyPart.LEFT_HAND).T, triangles

    @cached_property
    def _leg(self) -> _Parts:
        p, h = self.physique, self.physique.stature
        t, c = p.thighs, p.calves
        knee = (t + c) / 2
        leg = (p.hip_height - p.ankle_height) * h
        k = p.thigh_share
        rows = [
            (-0.16, -0.010, -0.002, 0.034 * t, 0.040 * t),
            (-0.07, -0.001, -0.002, 0.0445 * t, 0.0515 * t),
            (0.03, 0.003, 0.000, 0.0500 * t, 0.056 * t),
            (0.30 * k, 0.002, 0.003, 0.0460 * t, 0.053 * t),
            (0.62 * k, 0.000, 0.004, 0.0375 * t, 0.0430 * t),
            (0.88 * k, 0.000, 0.003, 0.0305 * knee, 0.0340 * knee),
            (1.02 * k, 0.000, 0.003, 0.0285 * knee, 0.0315 * knee),
            (1.12 * k, 0.000, -0.001, 0.0280 * knee, 0.0310 * knee),
            (k + 0.30 * (1 - k), 0.001, -0.008, 0.0310 * c, 0.0335 * c),
            (k + 0.60 * (1 - k), 0.000, -0.007, 0.0230 * c, 0.0250 * c),
            (k + 0.85 * (1 - k), 0.000, -0.005, 0.0165 * c, 0.0190 * c),
            (1.00, 0.000, -0.006, 0.0170 * c, 0.0195 * c),
        ]
        limb = _limb(self.point("hip"), self.frame(BodyPart.LEFT_THIGH), rows, leg, h)
        return [BlendedSolid(limb), BlendedSolid(self._foot(), 0.035 * h)]

    def _foot(self) -> Solid:
        p = self.physique
        u, g = p.stature * p.foot_length, p.foot_girth
        rows = [
            (-0.18, 0.000, 0.105, 0.100 * g, 0.105),
            (-0.08, 0.000, 0.125, 0.118 * g, 0.125),
            (0.08, 0.000, 0.125, 0.118 * g, 0.125),
            (0.24, 0.004, 0.098, 0.138 * g, 0.098),
            (0.46, 0.012, 0.068, 0.172 * g, 0.068),
            (0.60, 0.006, 0.058, 0.160 * g, 0.058),
            (0.68, -0.006, 0.052, 0.130 * g, 0.052),
        ]
        frame = np.stack([_LEFT, _UP, _FORWARD], axis=1)
        return Loft(self.point("ankle") * [1, 1, 0], frame, np.array(rows) * u, power=2.5, caps=(0.06 * u, 0.07 * u))


def _vector(x: float, y: float, z: float) -> FloatArray:
    return np.array([x, y, z])


def _limb(origin: FloatArray, frame: FloatArray, rows: Sequence[tuple[float, ...]], length: float, unit: float) -> Loft:
    """Loft along a bone: first column in bone lengths, the others in ``unit``."""
    return Loft(origin, frame, np.array(rows) * [length, unit, unit, unit, unit])


def _cone(start: FloatArray, end: FloatArray, start_radius: float, end_radius: float) -> Loft:
    """Round cone with spherical ends."""
    length = float(np.linalg.norm(end - start))
    rows = [(0, 0, 0, start_radius, start_radius), (length, 0, 0, end_radius, end_radius)]
    hint = _FORWARD if abs((end - start)[0]) < 0.8 * length else _UP
    return Loft(start, frame_along(end - start, hint), np.array(rows, dtype=np.float64))
