"""Slide of every contact since its beginning, and height of the contact point above the ground, in every frame."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import at_frames, sole_rows
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.grounds.ground import Ground
from studio.core.kernels.support.sole import HEEL_PAD_FRACTION
from studio.core.solver.grounding.body_support import contact_height, track_of
from studio.core.solver.grounding.footprints import planes_under, soles_of
from studio.core.solver.grounding.swing_foot_path import Sole, rounded_ground_height
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

TIPTOE_COSINE = 0.5
"""Cosine of the tilt of a foot below which it stands on its toes alone, whatever the position of its heel."""


@dataclass(frozen=True, eq=False)
class _Stances:
    """Successive stances of one contact point, K in number, as arrays over their n frames.

    ``frames`` (n,) are frame numbers, ``of`` (n,) is the index of the stance of each, and ``begins`` and ``middles``
    (K,) are the positions in these arrays at which stances begin and are halfway.
    """

    frames: IntArray
    of: IntArray
    begins: IntArray
    middles: IntArray

    @classmethod
    def between(cls, first: IntArray, stop: IntArray) -> "_Stances":
        lengths = stop - first
        begins = np.cumsum(lengths) - lengths
        of = np.repeat(np.arange(len(first)), lengths)
        return cls(np.arange(len(of)) + (first - begins)[of], of, begins, begins + lengths // 2)


def contact_tracks(
    adapted: AdaptedMotion, contacts: Sequence[ContactInterval], ground: Ground
) -> tuple[FloatArray, FloatArray]:
    """Slides and heights above the ground (9, F) in metres, with a row for each ``ContactPoint``; NaN without contact.

    A slide is the distance of a heel, or of the supporting end of a toe, from its position at the begin of the contact.
    ``contacts`` count frames in the whole motion.
    """
    slides, heights = np.full((2, len(ContactPoint), adapted.frame_count), np.nan)
    for row, point in enumerate(ContactPoint):
        spans = [(each.first, each.last + 1) for each in contacts if each.point is point]
        first, stop = np.clip(np.reshape(spans, (-1, 2)).T - adapted.first_frame, 0, adapted.frame_count).astype(int)
        if (stop > first).any():
            stances = _Stances.between(first[stop > first], stop[stop > first])
            standing = _standing_foot if point.is_foot else _standing_joint
            slides[row, stances.frames], heights[row, stances.frames] = standing(adapted, point, stances, ground)
    return slides, heights


def _standing_joint(
    adapted: AdaptedMotion, point: ContactPoint, stances: _Stances, ground: Ground
) -> tuple[FloatArray, FloatArray]:
    """Slide (n,) along the ground of a hand, a knee or the seat, and its height; a wrist over its finger tips has
    height 0.
    """
    body = adapted.body
    joint = track_of(point, body, adapted.positions[stances.frames])
    under = joint[stances.middles]
    normals = ground.normal_at(under)[stances.of]
    under[:, 2] = ground.height_at(under)
    heights = np.einsum("nk,nk->n", joint - under[stances.of], normals) - contact_height(body, point)
    if point.member == "hand":
        tips = adapted.positions[stances.frames, body.layout.wrist_point(point.side) + 1]
        over_tips = heights + np.einsum("nk,nk->n", tips - joint, normals)
        heights = np.minimum(heights, np.maximum(over_tips, 0.0))
    return _slide(joint, normals, stances), heights


def _slide(track: FloatArray, normals: FloatArray, stances: _Stances) -> FloatArray:
    """Distances (n,) along the ground of a track (n, 3) from the beginning of its contact."""
    way = track - track[stances.begins][stances.of]
    return np.asarray(np.linalg.norm(_along(way, normals), axis=1))


def _along(ways: FloatArray, normals: FloatArray) -> FloatArray:
    """Components of the vectors ``ways`` (n, 3) in the planes of ``normals`` (n, 3)."""
    return np.asarray(ways - np.einsum("nk,nk->n", ways, normals)[:, None] * normals)


def _stood_on(ball: FloatArray, tip: FloatArray, normals: FloatArray, stances: _Stances) -> FloatArray:
    """Displacements (n, 3) of toes in the planes of ``normals`` (n, 3).

    They are those of the stillest point between ball and tip, about which the toes rotate or over which they roll.
    """
    of_ball, of_tip = (_along(np.diff(each, axis=0, prepend=each[:1]), normals) for each in (ball, tip))
    change = of_tip - of_ball
    forward = -np.einsum("nk,nk->n", of_ball, change) / np.maximum(np.einsum("nk,nk->n", change, change), 1e-18)
    return np.cumsum(of_ball + np.clip(forward, 0.0, 1.0)[:, None] * change, axis=0)


def _standing_foot(
    adapted: AdaptedMotion, point: ContactPoint, stances: _Stances, ground: Ground
) -> tuple[FloatArray, FloatArray]:
    """Slide of the pad of a heel and height of its edge, or slide and height of the lower one of ball and tip of the
    toes.

    Over an edge the ground is the plane on which the foot stands.
    """
    layout, side, frames, of, middles = (
        adapted.morphology.layout,
        point.side,
        stances.frames,
        stances.of,
        stances.middles,
    )
    measures = at_frames(sole_rows(adapted.body, side), adapted.first_frame + frames)
    ankle, toe = adapted.positions[frames, layout.ankle_point(side)], adapted.positions[frames, layout.toe_point(side)]
    segment = layout.foot_segment(side)
    foot = adapted.rotations[frames, segment]
    soles = soles_of(ankle[middles], foot[middles], at_frames(measures, middles))
    planes = planes_under(ground, soles)
    steep = (foot[middles, 2, 2] < TIPTOE_COSINE) & (not point.is_heel)
    normals = np.where(steep[:, None], ground.normal_at(toe[middles]), planes.normals)[of]
    if point.is_heel:
        below = np.column_stack([-measures[:, 4], 0.0 * measures[:, 4], -measures[:, 3]])
        sole = ankle + np.einsum("fij,fj->fi", foot, np.broadcast_to(below, ankle.shape))
    else:
        sole = toe - (measures[:, 3] + measures[:, 2])[:, None] * normals
    heights = (sole[:, 2] - ground.height_at(sole)) * normals[:, 2]
    over = np.asarray(planes.overhangs.any(axis=1))
    if over.any():
        edges = np.column_stack([soles[:, 1], planes.heights])[of]
        heights = np.where(over[of], np.einsum("nk,nk->n", sole - edges, normals), heights)
    if point.is_heel:
        heading = _along(foot[:, :, 0], normals)
        heading /= np.maximum(np.linalg.norm(heading, axis=1, keepdims=True), 1e-9)
        return _slide(sole + HEEL_PAD_FRACTION * measures[:, 4:5] * heading, normals, stances), heights
    tip = Sole.of(ankle, foot, adapted.rotations[frames, segment + 1], measures).points[:, -1]
    tips = (tip[:, 2] - rounded_ground_height(ground, tip)) * normals[:, 2]
    return _slide(_stood_on(toe, tip, normals, stances), normals, stances), np.minimum(heights, tips)
