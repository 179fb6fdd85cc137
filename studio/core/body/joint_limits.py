"""Range of motion of the limb joints: swing of a bone from the middle of its range, twist, and bend, by joint.

The values are for the left side in degrees; the right side is the mirror image. A swing is about the axes of the joint
at the middle of its range: ``bone`` and ``hinge`` are the unit z and x axes, in the parent segment (arms in the thorax
as the clavicle carries it along; thorax and pelvis x forward, y left, z up). Twist is measured from the shortest arc,
after the swing.

=========  ==============================================  =====================================================
joint      range                                           source
=========  ==============================================  =====================================================
shoulder   flexion 167, extension 62, abduction 184,       Boone and Azen 1979; across the body 135, behind the
           inner and outer rotation 69, 104 abducted,      shoulder 45: AAOS 1965; beside the body: Kapandji 1982
           95, 80 beside the body
hip        flexion 122, extension 20, abduction 46,        Boone and Azen 1979; extension Kapandji 1982;
           adduction 27, inner and outer rotation 47       abduction of a bent hip 60: Kapandji 1982
elbow      0 to 150, carrying angle 15, forearm 80 to      AAOS 1965; forearm Boone and Azen 1979
           each side of the middle
knee       0 to 160 (on the heels, not by its muscles)     Kapandji 1982
wrist      80 every way (flexion 76, extension 75; the     Boone and Azen 1979
           direction of the palm in a capture's reference
           pose, and the twist of the forearm within its
           160 degrees, are unknown)
ankle      plantar flexion 56, inversion 37, eversion 21,  Boone and Azen 1979; dorsiflexion under load: Bennell
           dorsiflexion 45 under load                      and others 1998
=========  ==============================================  =====================================================

D. C. Boone, S. P. Azen: Normal range of motion of joints in male subjects, J. Bone Joint Surg. 61-A (1979); American
Academy of Orthopaedic Surgeons: Joint Motion (1965); I. A. Kapandji: The Physiology of the Joints (1982); K. Bennell
and others: Intra-rater and inter-rater reliability of a weight-bearing lunge, Aust. J. Physiother. 44 (1998). Swing and
twist as P. Baerlocher and R. Boulic: Parametrization and range of motion of the ball-and-socket joint (2001); a
boundary by direction as J. Wilhelms and A. Van Gelder: Fast and easy reach-cone joint limits (2001).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.kernels.limits.limb_joint_limits import LIMB_LIMITS, SWIVEL_SOFT_LIMIT_FRACTION
from studio.core.rotations import frame_along, normalized

FloatArray = NDArray[np.float64]
SEGMENT_FORWARD = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True)
class BallLimit:
    """Limits of a ball joint in degrees: the axes of the middle of its range, swing ``radii`` about x, -x, y and -y,
    and the range of ``twist``.
    """

    bone: tuple[float, float, float]
    hinge: tuple[float, float, float]
    radii: tuple[float, float, float, float]
    twist: tuple[float, float]

    @property
    def axes(self) -> FloatArray:
        """Axes (3, 3) of the joint at the middle of its range, as columns x, y, z."""
        return frame_along(normalized(np.array(self.bone)), np.array(self.hinge))


SHOULDER_RANGE = BallLimit((1.0, 1.0, -1.0), (1.0, -1.0, 0.0), (130.0, 105.0, 95.0, 105.0), (-40.0, 150.0))
"""Limits of the shoulder: about x the arm rises and sinks, about y it crosses the body and goes back."""
HIP_RANGE = BallLimit((0.75, 0.2, -0.64), (0.0, 1.0, 0.0), (75.0, 80.0, 55.0, 55.0), (-65.0, 60.0))
"""Limits of the hip: about x the thigh goes back and forward, about y out and in."""
WRIST_RANGE = BallLimit((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (80.0, 80.0, 80.0, 80.0), (-160.0, 160.0))
ANKLE_RANGE = BallLimit((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (21.0, 37.0, 56.0, 45.0), (-40.0, 40.0))
"""Limits of the ankle: about x of the foot its outer edge rises and sinks, about y its toes sink and rise."""
ELBOW_DEGREES, CARRYING_ANGLE_DEGREES, FOREARM_TWIST_DEGREES = (0.0, 150.0), 15.0, (-80.0, 80.0)
"""Range of the elbow's bend, its carrying angle, and the range of the forearm's twist, in degrees."""
KNEE_DEGREES, KNOCK_KNEE_DEGREES, SHANK_TWIST_DEGREES = (0.0, 160.0), 10.0, (-30.0, 30.0)
"""Range of the knee's bend, its greatest sideways angle, and the range of the shank's twist, in degrees."""
HINGE_MIRROR, UPRIGHT_MIRROR = np.array([-1.0, 1.0, 1.0]), np.array([1.0, -1.0, 1.0])
"""Signs that mirror the axes of a segment with a hinge, and of a segment whose y axis points left."""


def limb_limit_records(body: Morphology) -> NDArray[np.void]:
    """Writable records (4,) of ``kernels.limits.limb_joint_limits``, one for each limb of ``body``."""
    return np.frombuffer(bytearray(_limits_of(body)), dtype=LIMB_LIMITS)  # whole: NumPy copies records field by field


@lru_cache(maxsize=64)
def _limits_of(body: Morphology) -> bytes:
    limits = np.zeros(4, dtype=LIMB_LIMITS)
    for limb, row in enumerate(limits):
        side, is_arm = limb % 2, limb < 2
        root, tip = (SHOULDER_RANGE, WRIST_RANGE) if is_arm else (HIP_RANGE, ANKLE_RANGE)
        _write(row, 0, root, side, UPRIGHT_MIRROR, HINGE_MIRROR)
        _write(row, 1, tip, side, HINGE_MIRROR, HINGE_MIRROR if is_arm else UPRIGHT_MIRROR)
        if is_arm:
            row["axes"][0] = frame_along(normalized(body.clavicle_rest[side]), SEGMENT_FORWARD).T @ row["axes"][0]
        bends, slant, turn = (
            (ELBOW_DEGREES, CARRYING_ANGLE_DEGREES, FOREARM_TWIST_DEGREES)
            if is_arm
            else (KNEE_DEGREES, KNOCK_KNEE_DEGREES, SHANK_TWIST_DEGREES)
        )
        row["bends"], row["aslant"], row["turns"] = np.radians(bends), np.radians(slant), _range(turn, side)
    return limits.tobytes()


def _write(row: np.void, joint: int, ball: BallLimit, side: int, carrier: FloatArray, own: FloatArray) -> None:
    """Write the limits of a ball joint of the left side, or their mirror image, in the axes of the parent and of the
    segment.
    """
    axes, radii = ball.axes, np.radians(ball.radii)
    if side == 1:
        axes = carrier[:, None] * axes * own
        radii = radii[[0, 1, 3, 2]] if own is HINGE_MIRROR else radii[[1, 0, 2, 3]]
    twist = _range(ball.twist, side)
    row["axes"][joint], row["radii"][joint], row["twists"][joint] = axes, radii, twist
    well, middle = np.cos(SWIVEL_SOFT_LIMIT_FRACTION * np.array([radii.min(), twist[1]])), twist[0]
    row["inner_cosines"][joint] = [*well, np.cos(middle), np.sin(middle)]


def _range(degrees: tuple[float, float], side: int) -> FloatArray:
    """Middle and half width of a range, in radians, mirrored for the right side."""
    least, most = np.radians(degrees)
    return np.array([0.5 * (least + most) * (-1.0) ** side, 0.5 * (most - least)])
