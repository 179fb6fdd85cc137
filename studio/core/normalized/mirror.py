"""Mirror image of a motion in the median plane of the body."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch, contact_point
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.motion import NormalizedMotion
from studio.core.project_cache import project_cache

_SIDED = (
    (channel.CLAVICLE, 4), (channel.LIMB_FRAME, 4), (channel.LIMB_FRAME + 8, 4), (channel.LIMB_SLACK, 1),
    (channel.LIMB_SLACK + 2, 1), (channel.LIMB_OFF_PLANE, 1), (channel.LIMB_OFF_PLANE + 2, 1), (channel.LIMB_BEND, 1),
    (channel.LIMB_BEND + 2, 1), (channel.LIMB_TWIST, 2), (channel.LIMB_TWIST + 4, 2), (channel.HAND, 4),
    (channel.FOOT, 4), (channel.TOE, 4), (channel.HIP_SHIFT, 3),
)  # fmt: skip
"""First column of a left side, and number of columns; those of the right side follow."""
_OPPOSITE = (channel.HIPS + 1, channel.YAW, channel.HIP_SHIFT + 1, channel.HIP_SHIFT + 4, channel.HEAD_SHIFT + 1,
             *range(channel.LIMB_OFF_PLANE, channel.LIMB_BEND), *range(channel.LIMB_TWIST, channel.HAND))  # fmt: skip
"""Columns that change their sign: displacements to the left, rotations to the left, twists."""
_HINGED = range(channel.LIMB_FRAME, channel.LIMB_SLACK, 4)
"""Columns of limb frames: their x is a hinge axis, which a mirror reverses."""
_HANDS = (channel.HAND, channel.HAND + 4)
"""Columns of the hands, which rotate in a forearm's axes, whose x is a hinge as well."""


@project_cache(maxsize=32)
def mirrored_motion(motion: NormalizedMotion) -> NormalizedMotion:
    """Motion with left and right exchanged: y becomes -y.

    With M = diag(1, -1, 1) a rotation R between anatomical axes becomes M R M. Axes whose x is a hinge have D =
    diag(-1, 1, 1) on their side instead, because the cross product of two mirrored vectors is reversed.
    """
    channels = np.array(motion.channels)
    for left, count in _SIDED:
        own, other = slice(left, left + count), slice(left + count, left + 2 * count)
        channels[:, own], channels[:, other] = motion.channels[:, other], motion.channels[:, own]
    channels[:, _OPPOSITE] *= -1.0
    for column in (*channel.QUATERNION_COLUMNS, *range(channel.SPINE, channels.shape[1], 4)):
        x, y, z, w = channels[:, column : column + 4].T
        if column in _HINGED:  # M R D = M R M (M D), and M D is half a turn about z
            turned = [y, x, w, z]
        elif column in _HANDS:
            turned = [x, -y, -z, w]
        else:
            turned = [-x, y, -z, w]
        channels[:, column : column + 4] = np.stack(turned, axis=1)
    channels.setflags(write=False)
    girdle = motion.girdle and replace(
        motion.girdle, rest=motion.girdle.rest[::-1] * [1.0, -1.0, 1.0], limbs=motion.girdle.limbs[[1, 0, 3, 2]]
    )
    return replace(motion, channels=channels, girdle=girdle)


def mirrored_contacts(contacts: Sequence[ContactInterval]) -> tuple[ContactInterval, ...]:
    """Contacts on the other side; those of the seat, and of both hands, are unchanged."""
    return tuple(replace(each, point=mirrored_point(each.point)) for each in contacts)


def mirrored_point(point: ContactPoint | Touch) -> ContactPoint | Touch:
    """Contact point or touch of the other side."""
    swaps = {"left": "right", "right": "left"}
    side, _, member = point.value.partition("_")
    return contact_point(f"{swaps[side]}_{member}") if side in swaps else point
