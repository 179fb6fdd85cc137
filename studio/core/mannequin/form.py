"""The form of a mannequin: its parts as smooth solids laid along the bones of its rest pose.

All numbers are fractions of stature (of foot length in the foot) for an average man; the physique's factors
make the others. Only the left half is described: the field is symmetric about y = 0.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from studio.core.canonical import BodyPart
from studio.core.mannequin.field import Ellipsoid, Loft, Solid, smooth_union, union
from studio.core.mannequin.physique import Physique
from studio.core.morphology import FloatArray
from studio.core.rest_pose import frame_along, rest_pose

_FORWARD, _LEFT, _UP = np.eye(3)
_Parts = list[tuple[Solid, float]]


@dataclass(frozen=True)
class Form:
    """The solids of one physique in its rest pose."""

    physique: Physique

    @cached_property
    def rest(self) -> tuple[FloatArray, FloatArray]:
        """Positions and rotations of the rest pose."""
        return rest_pose(self.physique.morphology())

    def point(self, name: str) -> FloatArray:
        """World place of a point of the left half by its name in the layout, ``left`` left out."""
        names = self.physique.morphology().layout.point_names()
        place: FloatArray = self.rest[0][names.index(name if name in names else f"left {name}")]
        return place

    def frame(self, part: BodyPart) -> FloatArray:
        """World rotation of a segment."""
        rotation: FloatArray = self.rest[1][self.physique.morphology().layout.segment(part)]
        return rotation

    def distance(self, points: FloatArray) -> FloatArray:
        """(N,) signed distance of the whole body from (N, 3) world points."""
        torso, neck, skull, arm, leg = self.regions(points)
        h = self.physique.stature
        head = smooth_union(neck, skull, 0.030 * h)
        body = smooth_union(smooth_union(torso, head, 0.035 * h), arm, 0.040 * h)
        return smooth_union(body, leg, 0.040 * h)

    def regions(self, points: FloatArray) -> tuple[FloatArray, ...]:
        """Signed distances of torso, neck, skull, arm and leg apart; the nearer of left and right."""
        half = points * [1, 1, 1]
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
            (-0.10, 0.000, 0.046, 0.056 * p.hips),
            (0.01, -0.002, 0.061 * p.seat, 0.091 * p.hips),
            (0.14, 0.000, 0.059, 0.086 * p.hips),
            (0.30, 0.003, 0.054 * p.waist, 0.074 * p.waist),
            (0.46, 0.004, 0.058 * (p.waist + p.chest_depth) / 2, 0.079 * (p.waist + p.chest) / 2),
            (0.62, 0.001, 0.065 * p.chest_depth, 0.089 * p.chest),
            (0.77, -0.006, 0.062 * p.chest_depth, 0.092 * p.chest),
            (0.88, -0.013, 0.047 * p.chest_depth, 0.076 * wide),
            (0.97, -0.016, 0.034, 0.040 * wide),
        ]
        stations = (
            np.array([(hip + (top - hip) * t, x, 0, depth, breadth) for t, x, depth, breadth in rows]) * h
        )
        trunk = Loft(np.zeros(3), np.eye(3), stations, power=2.25, caps=(0.03 * h, 0.02 * h))

        def blob(
            t: float, x: float, y: float, radii: tuple[float, float, float], fillet: float
        ) -> tuple[Solid, float]:
            centre = np.array([x, y, hip + (top - hip) * t]) * h
            return Ellipsoid(centre, np.array(radii) * h, np.eye(3)), fillet * h

        parts: _Parts = [(trunk, 0.0)]
        seat = 0.046 * p.seat
        parts.append(blob(0.01, -0.030 * p.seat, 0.040 * p.hips, (seat, 0.042 * p.hips, 0.050), 0.05))
        if p.pectorals:
            parts.append(
                blob(
                    0.69,
                    0.040 * p.chest_depth,
                    0.042 * wide,
                    (0.026 * p.pectorals, 0.046 * wide, 0.034),
                    0.05,
                )
            )
        if p.bust:
            parts.append(blob(0.60, 0.050, 0.043, (0.036 * p.bust, 0.036 * p.bust, 0.036 * p.bust), 0.035))
        if p.belly:
            parts.append(
                blob(0.27, 0.010 + 0.02 * p.belly, 0.0, (0.062 * p.belly, 0.080 * p.belly, 0.085), 0.08)
            )
        shoulder, neck = self.point("shoulder"), self.point("neck base")
        inner, outer = neck + [0.004 * h, 0.012 * h, 0.020 * h], shoulder + [-0.004 * h, -0.02 * h, 0.010 * h]
        parts.append((_cone(inner, outer, 0.022 * h * p.neck_girth, 0.024 * h * p.shoulders), 0.05 * h))
        return parts

    @cached_property
    def _neck(self) -> _Parts:
        p, h = self.physique, self.physique.stature
        girth = 0.0335 * h * p.neck_girth
        low = self.point("neck base") + [0.004 * h, 0, -0.015 * h]
        high = self.point("head joint") + [0.016 * h, 0, 0.010 * h]
        return [(_cone(low, high, 1.1 * girth, 0.95 * girth), 0.0)]

    @cached_property
    def _skull(self) -> _Parts:
        p = self.physique
        u = p.stature * p.head / 0.088
        joint, s = self.point("head joint"), p.skull

        def blob(
            place: tuple[float, float, float], radii: tuple[float, float, float], tilt: float = 0.0
        ) -> Solid:
            c, d = np.cos(tilt), np.sin(tilt)
            frame = np.array([[c, 0, d], [0, 1, 0], [-d, 0, c]])
            return Ellipsoid(joint + np.array(place) * u, np.array(radii) * u, frame)

        return [
            (blob((0.011, 0, 0.034), (0.056 * s, 0.045 * s, 0.054)), 0.0),
            (blob((0.030, 0, 0.002), (0.034, 0.034 * s, 0.049), 0.15), 0.045 * u),
            (blob((0.044, 0, -0.026), (0.018, 0.020, 0.016)), 0.03 * u),
            (blob((0.066, 0, 0.004), (0.009, 0.008, 0.017), -0.35), 0.02 * u),
            (blob((0.008, 0.043 * s, 0.008), (0.010, 0.006, 0.017), -0.2), 0.012 * u),
        ]

    @cached_property
    def _arm(self) -> _Parts:
        p, h = self.physique, self.physique.stature
        a, f = p.arms, p.forearms
        shoulder, elbow, wrist = self.point("shoulder"), self.point("elbow"), self.point("wrist")
        upper_rows = [
            (-0.02, 0.0, 0.0, 0.026 * a, 0.030 * a),
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
        radii = np.array([0.034, 0.030, 0.036]) * h * p.shoulders
        deltoid = Ellipsoid(shoulder + np.array([-0.002, 0.004, -0.002]) * h, radii, np.eye(3))
        return [(deltoid, 0.0), (upper, 0.04 * h), (lower, 0.02 * h), *self._hand(wrist)]

    def _hand(self, wrist: FloatArray) -> _Parts:
        p = self.physique
        u, g = p.stature * p.hand, p.hand_girth
        frame = self.frame(BodyPart.LEFT_HAND)
        palm_rows = [
            (-0.06, 0.000, 0.000, 0.115 * g, 0.150 * g),
            (0.18, 0.000, -0.010, 0.112 * g, 0.185 * g),
            (0.48, -0.005, 0.005, 0.100 * g, 0.205 * g),
            (0.72, 0.025, 0.010, 0.082 * g, 0.185 * g),
            (0.94, 0.100, 0.012, 0.062 * g, 0.135 * g),
        ]
        palm = Loft(wrist, frame, np.array(palm_rows) * u, power=2.4, caps=(0.05 * u, 0.07 * u))
        root, knuckle, tip = ((0.02, -0.11, 0.14), (0.08, -0.24, 0.34), (0.12, -0.285, 0.56))
        bones = [wrist + frame @ (np.array(place) * u) for place in (root, knuckle, tip)]
        base = _cone(bones[0], bones[1], 0.095 * u * g, 0.078 * u * g)
        thumb = _cone(bones[1], bones[2], 0.078 * u * g, 0.058 * u * g)
        return [(palm, 0.10 * u), (base, 0.12 * u), (thumb, 0.03 * u)]

    @cached_property
    def _leg(self) -> _Parts:
        p, h = self.physique, self.physique.stature
        t, c = p.thighs, p.calves
        knee = (t + c) / 2
        leg = (p.hip_height - p.ankle_height) * h
        inward = 0.0015
        thigh_rows = [
            (-0.08, inward, 0.000, 0.042 * t, 0.050 * t),
            (0.08, inward, 0.000, 0.0485 * t, 0.056 * t),
            (0.30, 0.001, 0.003, 0.0455 * t, 0.052 * t),
            (0.60, 0.000, 0.004, 0.0375 * t, 0.0425 * t),
            (0.88, 0.000, 0.002, 0.0300 * knee, 0.0330 * knee),
            (1.00, 0.000, 0.002, 0.0285 * knee, 0.0320 * knee),
        ]
        shank_rows = [
            (0.00, 0.000, 0.002, 0.0285 * knee, 0.0320 * knee),
            (0.12, 0.000, -0.002, 0.0275 * knee, 0.0305 * knee),
            (0.30, 0.001, -0.008, 0.0310 * c, 0.0335 * c),
            (0.60, 0.000, -0.006, 0.0225 * c, 0.0245 * c),
            (0.85, 0.000, -0.005, 0.0165 * c, 0.0190 * c),
            (1.00, 0.000, -0.006, 0.0175 * c, 0.0195 * c),
        ]
        thigh = _limb(self.point("hip"), self.frame(BodyPart.LEFT_THIGH), thigh_rows, leg * p.thigh_share, h)
        shank = _limb(
            self.point("knee"), self.frame(BodyPart.LEFT_SHANK), shank_rows, leg * (1 - p.thigh_share), h
        )
        return [(thigh, 0.0), (shank, 0.02 * h), (self._foot(), 0.035 * h)]

    def _foot(self) -> Solid:
        p = self.physique
        u, g = p.stature * p.foot_length, p.foot_girth
        rows = [
            (-0.18, 0.000, 0.105, 0.100 * g, 0.105),
            (-0.08, 0.000, 0.125, 0.118 * g, 0.125),
            (0.08, 0.000, 0.125, 0.118 * g, 0.125),
            (0.24, 0.004, 0.095, 0.138 * g, 0.095),
            (0.46, 0.012, 0.062, 0.172 * g, 0.062),
            (0.60, 0.006, 0.050, 0.158 * g, 0.050),
            (0.70, -0.008, 0.042, 0.120 * g, 0.042),
        ]
        frame = np.stack([_LEFT, _UP, _FORWARD], axis=1)
        return Loft(
            self.point("ankle") * [1, 1, 0], frame, np.array(rows) * u, power=2.5, caps=(0.06 * u, 0.06 * u)
        )


def _limb(
    origin: FloatArray, frame: FloatArray, rows: list[tuple[float, ...]], length: float, unit: float
) -> Loft:
    """A loft along a bone: first column in bone lengths, the others in ``unit``."""
    return Loft(origin, frame, np.array(rows) * [length, unit, unit, unit, unit])


def _cone(start: FloatArray, end: FloatArray, start_radius: float, end_radius: float) -> Loft:
    """A round cone with spherical ends."""
    length = float(np.linalg.norm(end - start))
    rows = [(0, 0, 0, start_radius, start_radius), (length, 0, 0, end_radius, end_radius)]
    hint = _FORWARD if abs((end - start)[0]) < 0.8 * length else _UP
    return Loft(start, frame_along(end - start, hint), np.array(rows, dtype=np.float64))
