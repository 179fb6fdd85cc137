"""Steps on the spot: feet that stand are lifted one after the other, so that a body may stand elsewhere afterwards."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from studio.core.captures.contacts import ContactInterval
from studio.core.kernels import layout as at
from studio.core.normalized.motion import NormalizedMotion

STEP_SECONDS, STEP_HEIGHT = 0.6, 0.06
"""What a step of both feet takes, and how high each is lifted, in leg lengths."""


def stepping(
    motion: NormalizedMotion, contacts: Sequence[ContactInterval], change: int
) -> tuple[NormalizedMotion, tuple[ContactInterval, ...]]:
    """A motion whose left foot, then its right one, is lifted from frame ``change`` on, and what still stands."""
    channels, parts = motion.channels.copy(), list(contacts)
    half = round(0.5 * STEP_SECONDS * motion.frame_rate)
    for side in (0, 1):
        first, last = change + side * half, change + (side + 1) * half
        frames = np.arange(first, min(last + 1, len(channels)))
        channels[frames, at.LIMB_SLACK + 2 + side] += STEP_HEIGHT * np.sin(np.pi * (frames - first) / half) ** 2
        parts = [part for each in parts for part in _lifted(each, side, first, last)]
    return replace(motion, channels=channels), tuple(parts)


def _lifted(contact: ContactInterval, side: int, first: int, last: int) -> list[ContactInterval]:
    """What is left of a contact when the foot of ``side`` is in the air from ``first`` to ``last``."""
    if not contact.point.is_foot or contact.point.side != side or contact.last < first or contact.first > last:
        return [contact]
    parts = []
    if contact.first < first:
        parts.append(replace(contact, last=first - 1))
    if contact.last > last:
        parts.append(replace(contact, first=last + 1))
    return parts
