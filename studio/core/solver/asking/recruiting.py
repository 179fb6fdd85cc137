"""Arms and legs that a balance may recruit: which are free, when, and how far they may turn then (METHOD 7)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, at_frames, sole_rows
from studio.core.captures.contacts import ContactInterval, contact_mask
from studio.core.grounds.ground import Ground
from studio.core.single import PoseArray
from studio.core.solver.asking.chains import HIP_LIMIT, point_masses
from studio.core.solver.standing.blends import freedom

FloatArray = NDArray[np.float64]


def limb_freedoms(
    limbs: NDArray[np.int64],
    ranks: NDArray[np.int64],
    activations: FloatArray,
    contacts: Sequence[ContactInterval],
    frame_rate: float,
) -> FloatArray:
    """(L, 4, F) 0 while a limb stands or anything of a level's rank or above is asked of it, eased to 1 soon after and
    before.

    ``limbs`` (C, 2) those on which each constraint has a point, ``ranks`` (C,), ``activations`` (C, F). However little
    is asked, it is to be exactly there: so a limb is back in the motion's own pose when its task begins.
    """
    taken = np.zeros((int(ranks.max(initial=-1)) + 1, 4, activations.shape[1]), dtype=np.bool_)
    for limb in range(4):
        spans = [(each.first, each.last) for each in contacts if each.point.limb == limb]
        taken[:, limb] = contact_mask(spans, activations.shape[1])
        for c in np.flatnonzero((limbs == limb).any(axis=1)):
            taken[ranks[c] :, limb] |= activations[c] > 0.0
    return np.array([[freedom(each, frame_rate) for each in level] for level in taken])


def leg_room(body: AnyMorphology, ground: Ground, positions: PoseArray, window: slice = slice(None)) -> FloatArray:
    """(2, F) part of its limit to which each leg may turn about its hip, however it turns, and not enter the ground.

    A point c metres above the ground and h beside the hip may turn c / h. Of the limit and what ankle, ball and tip of
    the foot may turn it is the smooth minimum. Of ``positions`` (all, P, 3) the F frames of ``window`` count.
    """
    found, positions = [], positions[window]
    for side in range(2):
        hip, soles = body.layout.hip(side), at_frames(sole_rows(body, side), window)
        points = positions[:, hip + 2 : hip + 5]
        soles_above = np.stack([soles[:, 3], np.maximum(soles[:, 3] + soles[:, 2], 0.0), np.zeros(len(soles))], axis=1)
        above = np.maximum(points[..., 2] - ground.height_at(points) - soles_above, 1e-9)
        beside = np.linalg.norm(points[..., :2] - positions[:, hip : hip + 1, :2], axis=-1)
        found.append((1.0 + ((HIP_LIMIT * beside / above) ** 4).sum(axis=1)) ** -0.25)
    return np.array(found)


def arm_lever(body: AnyMorphology, positions: PoseArray, window: slice = slice(None)) -> FloatArray:
    """(2, F) part of its limit to which each arm may turn about its shoulder: how upright its mass hangs or is raised.

    One that lies level along the way that the body is to take helps turned up as turned down: passing there, it would
    change from one to the other between two frames. ``positions`` (all, P, 3) and ``window`` as ``leg_room`` has them.
    """
    found, positions, masses = [], positions[window], point_masses(body.layout)
    for side in range(2):
        shoulder = body.layout.collar(side) + 1
        arm = slice(shoulder, shoulder + 4)
        lever = np.einsum("p,fpi->fi", masses[arm], positions[:, arm] - positions[:, shoulder : shoulder + 1])
        found.append(lever[:, 2] ** 2 / np.maximum((lever**2).sum(axis=1), 1e-12))
    return np.array(found)
