"""Contacts of feet on force plates, which show to the millisecond when a foot lands and leaves."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import ContactPoint, Span, contact_mask, spans_of
from studio.core.markers.force_plates import PlateLoad

FloatArray = NDArray[np.float64]

PLATE_OVERHANG_METRES = 0.03
"""Distance in metres by which heel, ball or tip of a foot may lie outside the plate, because markers are beside the
foot.
"""
LEAST_STANDING_FRACTION = 0.5
"""Least fraction of the time of a load in which the motion shows the foot standing on the plate."""
UNLOADED_SECONDS = 0.2
"""Longest time in seconds before or after a load in which a foot rests on the plate without loading it."""


def contacts_fitted_to_plates(
    feet: Mapping[ContactPoint, list[Span]], soles: FloatArray, loads: Sequence[PlateLoad], frame_rate: float
) -> dict[ContactPoint, list[Span]]:
    """Contacts ``feet``, with each step on a plate set to the first and last frame of its load.

    ``soles`` (F, 2, 3, 3) are as in ``detect_contacts``. A load under both feet, or under a foot that extends beyond
    the plate, is ignored. Frames of a load without a contact take the contact of the nearest frame that has one.
    """
    found = dict(feet)
    reach = round(UNLOADED_SECONDS * frame_rate)
    for load in loads:
        frames = np.arange(load.first, min(load.last + 1, len(soles)))
        masks = {point: contact_mask(spans, len(soles)) for point, spans in found.items()}
        sides = [[point for point in masks if point.side == side] for side in range(2)]
        stands = np.array([np.any([masks[point] for point in points], axis=0) for points in sides])
        over = np.all(_over(soles[frames][..., :2], load.corners), axis=2).T
        treads = np.flatnonzero((over & stands[:, frames]).any(axis=1))
        if len(treads) != 1:
            continue
        (side,) = treads
        known = np.flatnonzero(stands[side, frames])
        if len(known) < LEAST_STANDING_FRACTION * len(frames) or not over[side, known].all():
            continue
        nearest = known[np.rint(np.interp(np.arange(len(frames)), known, np.arange(len(known)))).astype(int)]
        stances = [(a, b) for a, b in spans_of(stands[side]) if a <= frames[-1] and b >= frames[0]]
        begin, end = stances[0][0], stances[-1][1]
        for point in sides[side]:
            mask = masks[point]
            mask[frames] = mask[frames[nearest]]
            if load.first - begin <= reach:
                mask[begin : load.first] = False
            if end - load.last <= reach:
                mask[load.last + 1 : end + 1] = False
            found[point] = spans_of(mask)
    return found


def _over(points: FloatArray, corners: FloatArray) -> NDArray[np.bool_]:
    """Mask (...) of the ``points`` (..., 2) above a plate with ``corners`` (4, 2), or within ``PLATE_OVERHANG_METRES``
    of it.
    """
    edges = np.roll(corners, -1, axis=0) - corners
    inward = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1, keepdims=True)
    inward *= np.sign(np.sum((corners.mean(axis=0) - corners) * inward, axis=1, keepdims=True))
    distances = np.einsum("...cd,cd->...c", points[..., None, :] - corners, inward)
    return np.asarray((distances > -PLATE_OVERHANG_METRES).all(axis=-1))
