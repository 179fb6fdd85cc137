"""Indices of a canonical body's points and segments, relative to its number K of spine segments.

The K + 23 points and K + 18 segments are in depth-first order, spine first (``core.body.canonical.BodyLayout``).
Segment k of the spine begins at point k. The shoulder of a side is ``K + SHOULDER_POINT + POINTS_PER_LIMB * side``, and
likewise for segments. Limbs 0 and 1 are arms, 2 and 3 legs.
"""

POINTS_BESIDE_SPINE = 23
"""Number of points of a body without the K of its spine."""
SEGMENTS_BESIDE_SPINE = 18
"""Number of segments of a body without the K of its spine."""
POINTS_PER_LIMB = 5
"""Number of points of one side's arm or leg: collar or hip, and the points beyond."""
SEGMENTS_PER_LIMB = 4
"""Number of segments of one side's arm with its clavicle, or leg."""

COLLAR_POINT = 3
SHOULDER_POINT = 4
WRIST_POINT = 6
HIP_POINT = 13
ANKLE_POINT = 15
TOE_POINT = 16

CLAVICLE_SEGMENT = 2
UPPER_ARM_SEGMENT = 3
HAND_SEGMENT = 5
THIGH_SEGMENT = 10
FOOT_SEGMENT = 12
TOE_SEGMENT = 13
