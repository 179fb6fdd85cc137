"""Support of a body by hands, knees and seat beside its feet, each contact at one position of the ground (METHOD 6).

The root of a motion is normalised by the legs. While hands, knees or seat support the body (a handstand, a crawl), the
root moves to its position at the end of the chain from them on this body, blended over time by their weights ([K05],
closing remarks). Then it is moved and rotated by the small remainder, so that all contacts are exactly in reach.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyLayout
from studio.core.body.morphology import AnyMorphology, Morphology, arm_rows, leg_rows
from studio.core.captures.contacts import (
    BODY_POINTS,
    ContactInterval,
    ContactPoint,
    contact_mask,
    spans_of,
    touching_points,
)
from studio.core.compact_array import PoseArray
from studio.core.grounds.ground import Ground
from studio.core.kernels import channel_columns as channel
from studio.core.kernels import measure_columns as measure
from studio.core.kernels.algebra.medians import geometric_median
from studio.core.kernels.limbs.limb import SOLE_SOFT_IK_THRESHOLD
from studio.core.kernels.support.foot_anchoring import SMALL_BODY_RATIO
from studio.core.kernels.support.gap_interpolation import interpolate_gaps
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.core.rotations import normalized, shortest_arc
from studio.core.runs import runs_of
from studio.core.solver.grounding.captured_floor import captured_floor
from studio.core.solver.grounding.contact_blending import (
    DISPLACEMENT_RETURN_SECONDS,
    RELEASE_SECONDS,
    ROOT_AVERAGE_SECONDS,
    hann_average,
    interpolated_corrections,
    release_weight,
    smoothstep_array,
)
from studio.core.solver.grounding.footing import foot_states
from studio.core.solver.grounding.footprints import tilts_of
from studio.core.solver.grounding.trunk_arching import arch_trunk

FloatArray = NDArray[np.float64]

CONTACT_HEIGHTS = {"hand": 0.065, "knee": 0.065, "seat": 0.12}
"""Heights of wrist, knee and middle of the hips above the ground in contact, in leg lengths."""
LYING_KNEE_HEIGHT = 0.1
"""Height of a knee above the ground, in leg lengths, up to which its leg lies; from twice this on its foot carries
load.
"""
CONTACT_RESIDUAL = 5e-4
"""Residual of a contact in metres from which the contact is moved to where the body reaches it."""
SLOPE_RADIUS = 0.6
"""Radius around the root, in leg lengths, over which the ground's slope for a tilted body is averaged."""
ARM_STIFFNESS = 6.0
"""Cost of shortening a raised arm by a metre, relative to swinging its end by a metre."""
LEVEL_HAND_SINE = 0.7
"""Sine of the greatest angle between the ground and fingers, or a palm, that are laid on it."""


@dataclass(frozen=True, eq=False)
class GroundContact:
    """Contact of a hand, a knee or the seat with the ground."""

    point: ContactPoint
    standing: NDArray[np.bool_]
    """(F,) True in contact."""
    places: FloatArray
    """(F, 3) positions of the joint in contact, metres."""
    normals: FloatArray
    """(F, 3) normals of the ground."""
    heights: FloatArray
    """(F,) height of the joint above the ground along the normal, metres."""

    def displaced(self, track: FloatArray, frame_rate: float) -> FloatArray:
        """``track`` (F, 3) of the point, blended to the contact positions, and back soon after."""
        return track + interpolated_corrections(
            np.where(self.standing[:, None], self.places - track, 0.0), self.standing, frame_rate
        )

    def moved(self, misses: FloatArray, ground: Ground) -> "GroundContact":
        """Contact with each position moved along the ground by its greatest residual ``misses`` (F, 3); the same object
        if none is greater than ``CONTACT_RESIDUAL``.
        """
        places, normals, lengths = self.places.copy(), self.normals.copy(), np.linalg.norm(misses, axis=1)
        for first, past in runs_of(self.standing):
            worst = first + int(lengths[first:past].argmax())
            if lengths[worst] > CONTACT_RESIDUAL:
                on_ground = places[first] - self.heights[first] * normals[first] + misses[worst]
                places[first:past], normals[first:past] = _place_on(on_ground[:2], self.heights[first], ground)
        return self if np.array_equal(places, self.places) else replace(self, places=places, normals=normals)


@dataclass(frozen=True, eq=False)
class BodySupport:
    """Support of a body by hands, knees and seat beside its feet."""

    holds: tuple[GroundContact, ...]
    """Contacts."""
    shift: FloatArray
    """(F, 3) displacement of the root, metres."""
    feet_fraction: FloatArray
    """(F,) fraction of the body's weight on the feet."""
    pose: tuple[FloatArray, FloatArray]
    """Positions (F, P, 3) and rotations (F, S, 3, 3) of the body tilted with the ground, before the displacement."""
    upright: FloatArray
    """(F, P, 3) untilted pose over the same positions of the ground, from which feet are planned."""


def contact_height(body: AnyMorphology, point: ContactPoint) -> float:
    """Height in metres of a wrist, knee or the middle of the hips above the ground in contact; of a wrist, for a flat
    palm.
    """
    return body.leg_length * CONTACT_HEIGHTS[point.member]


def track_of(point: ContactPoint, body: AnyMorphology, positions: PoseArray) -> FloatArray:
    """Track (F, 3) of a contact point in ``positions`` (F, P, 3): that of a joint, or of the middle of the hips."""
    return np.asarray(positions[:, touching_points(point, body.layout)].mean(axis=1))


def limb_freedom(contacts: Sequence[ContactInterval], limb: int, frame_count: int, frame_rate: float) -> FloatArray:
    """Release weight (F,) of a limb from its contacts: 0 in contact, rising to 1 soon after and before; 1 for limb
    -1.
    """
    spans = [(each.first, each.last) for each in contacts if each.point.limb == limb] if limb >= 0 else []
    if not spans:
        return np.ones(frame_count)
    return release_weight(contact_mask(spans, frame_count), frame_rate)


def find_support(
    motion: NormalizedMotion,
    body: AnyMorphology,
    contacts: Sequence[ContactInterval],
    ground: Ground,
    positions: FloatArray,
    rotations: FloatArray,
    actor: Morphology | None = None,
) -> BodySupport | None:
    """Support of a retargeted motion beside its feet; None if only feet are in contact.

    Trunks are bent in place, ``positions`` (F, P, 3) and ``rotations``, for hands that hang lower than the actor's.
    Arms in contact take the directions of the ``actor``'s arms, if the actor is known.
    """
    carrying = [each for each in contacts if not each.point.is_foot and each.first < motion.frame_count]
    if not carrying:
        return None
    spans = {
        point: sorted((each.first, min(each.last, motion.frame_count - 1)) for each in carrying if each.point is point)
        for point in BODY_POINTS
    }
    standing = {point: contact_mask(spans[point], motion.frame_count) for point in BODY_POINTS if spans[point]}
    bearing = _bearing(body, ground, positions)
    fractions = _support_weights(standing, foot_states(contacts, motion.frame_count), bearing, motion.frame_rate)
    pose, upright = (positions, rotations), positions
    if not ground.is_level:
        leans = hann_average(
            1.0 * np.any(list(standing.values()), axis=0)[:, None], DISPLACEMENT_RETURN_SECONDS, motion.frame_rate
        )
        leant, turned, upright = tilt_with_ground(leans, body, ground, motion.frame_rate, positions, rotations)
        pose = leant, turned
    positions = pose[0]
    actors, layout = (positions, body.layout) if actor is None else (realize_motion(motion, actor)[0], actor.layout)
    bones = arm_bones(body, actors, layout)
    rises = np.zeros((motion.frame_count, 2))
    if actor is not None and ground.is_level:
        scale = leg_rows(body, 0).sum(axis=1) / actor.leg_length
        lower = scale[:, None] * _hands_over_root(actors, layout) - _hands_over_root(positions, body.layout, bones)
        rises = scale[:, None] * _wrists_over_palms(contacts, actors, actor, motion.frame_rate) - np.maximum(lower, 0.0)
        arch_trunk(_raises(standing, lower, motion.frame_rate), body, positions, rotations)
    tracks = {point: _track(point, bones, body, ground, positions) for point in standing}
    holds = tuple(_hold(point, spans[point], body, ground, tracks[point], rises) for point in standing)
    shift = np.zeros((motion.frame_count, 3))
    for hold, fraction in zip(holds, fractions[1:], strict=True):
        away = np.where(hold.standing[:, None], hold.places - tracks[hold.point], 0.0)
        interpolate_gaps(away, hold.standing)
        shift += fraction[:, None] * away
    shift = hann_average(shift, ROOT_AVERAGE_SECONDS, motion.frame_rate)
    if ground.is_level:
        holds = tuple(
            _reached(hold, tracks[hold.point] + shift, body, ground, positions + shift[:, None]) for hold in holds
        )
    return BodySupport(holds, shift, fractions[0], pose, upright)


def arm_bones(body: AnyMorphology, actors: FloatArray, layout: BodyLayout) -> FloatArray:
    """Vectors (2, F, 2, 3) in metres along upper arm and forearm of a body, with the directions of the actor's.

    ``actors`` (F, P, 3) are the actor's points in the order of ``layout``. A folded arm that keeps the vector from
    shoulder to wrist with bones of other lengths would have other directions.
    """
    wrists = [layout.wrist_point(side) for side in range(2)]
    displacements = np.array([np.diff(actors[:, wrist - 2 : wrist + 1], axis=1) for wrist in wrists])
    lengths = np.array([arm_rows(body, side)[..., None] for side in range(2)])
    return np.asarray(normalized(displacements) * lengths)


def _hands_over_root(positions: FloatArray, layout: BodyLayout, bones: FloatArray | None = None) -> FloatArray:
    """Heights (F, 2) in metres of both wrists above the root; with ``bones`` (2, F, 2, 3), of arms with those bones."""
    wrists = np.array([layout.wrist_point(side) for side in range(2)])
    heights = positions[:, wrists, 2] if bones is None else positions[:, wrists - 2, 2] + bones[..., 2].sum(axis=2).T
    return np.asarray(heights - positions[:, :1, 2])


def _raises(standing: Mapping[ContactPoint, NDArray[np.bool_]], lower: FloatArray, frame_rate: float) -> FloatArray:
    """Rise (F,) in metres of the trunk for hands in contact that hang ``lower`` (F, 2) than the actor's, fading in and
    out.
    """
    fractions = np.zeros_like(lower)
    for point, stands in standing.items():
        if point.member == "hand":
            fractions[:, point.side] = 1.0 - release_weight(stands, frame_rate, DISPLACEMENT_RETURN_SECONDS)
    mean = (fractions * lower).sum(axis=1, keepdims=True) / np.maximum(fractions.sum(axis=1, keepdims=True), 1e-9)
    return np.asarray(hann_average(fractions.max(axis=1, keepdims=True) * mean, ROOT_AVERAGE_SECONDS, frame_rate)[:, 0])


def _track(
    point: ContactPoint, bones: FloatArray, body: AnyMorphology, ground: Ground, positions: FloatArray
) -> FloatArray:
    """Track (F, 3) of a contact point; that of a hand on level ground is computed from the ``bones`` (2, F, 2, 3) of
    its arm.
    """
    if point.member != "hand" or not ground.is_level:
        return track_of(point, body, positions)
    return np.asarray(positions[:, body.layout.wrist_point(point.side) - 2] + bones[point.side].sum(axis=1))


def _reached(
    hold: GroundContact, track: FloatArray, body: AnyMorphology, ground: Ground, positions: FloatArray
) -> GroundContact:
    """Contact of a hand, moved to where an arm that is longer than the actor's lands when it swings."""
    if hold.point.member != "hand":
        return hold
    shoulders = positions[:, body.layout.wrist_point(hold.point.side) - 2]
    wrists = raise_by_swinging(track, shoulders, np.maximum(hold.places[:, 2] - track[:, 2], 0.0))
    places, normals = hold.places.copy(), hold.normals.copy()
    for first, last in spans_of(hold.standing):
        span = slice(first, last + 1)
        places[span], normals[span] = _place_on(median_position(wrists[span]), hold.heights[first], ground)
    return replace(hold, places=places, normals=normals)


def tilt_with_ground(
    fraction: FloatArray,
    body: AnyMorphology,
    ground: Ground,
    frame_rate: float,
    positions: FloatArray,
    rotations: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(positions, rotations, upright positions) of poses tilted by ``fraction`` (F, 1) of the ground's slope.

    They are tilted about the position under the root. The last are the untilted ``positions``, translated over the
    tilted ones.
    """
    ring = np.pi / 4.0 * np.arange(8)
    round_root = SLOPE_RADIUS * body.leg_length * np.column_stack([np.cos(ring), np.sin(ring)])
    heights = ground.height_at(positions[:, :1, :2] + round_root)
    slopes = hann_average(heights @ round_root / np.sum(round_root[:, 0] ** 2), RELEASE_SECONDS, frame_rate)
    normals = np.column_stack([-slopes, np.ones(len(slopes))])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rotation_matrices = Rotation.from_rotvec(fraction * tilts_of(normals)).as_matrix()
    under = np.column_stack([positions[:, 0, :2], np.full(len(positions), ground.height)])[:, None]
    lean = np.swapaxes(rotation_matrices, 1, 2)
    upright = positions.copy()
    upright[..., :2] = (under + (positions - under) * [1.0, 1.0, 0.0] @ lean)[..., :2]
    return under + (positions - under) @ lean, rotation_matrices[:, None] @ rotations, upright


def _wrists_over_palms(
    contacts: Sequence[ContactInterval], positions: FloatArray, body: Morphology, frame_rate: float
) -> FloatArray:
    """Heights (F, 2) in metres by which wrists are above those of flat palms, as far as the fingers slope down."""
    wrists = np.array([body.layout.wrist_point(side) for side in range(2)])
    palms = captured_floor(contacts, positions, body, frame_rate)[:, None] + CONTACT_HEIGHTS["hand"] * body.leg_length
    heights, tips = positions[:, wrists, 2], positions[:, wrists + 1, 2]
    return np.maximum(heights - np.maximum(tips, palms), 0.0)


def _hold(
    point: ContactPoint,
    spans: list[tuple[int, int]],
    body: AnyMorphology,
    ground: Ground,
    track: FloatArray,
    rises: FloatArray,
) -> GroundContact:
    """Contact of one point in the intervals ``spans`` of frames (both ends included).

    Each position is the median of the joint's ``track`` (F, 3), while the body is small if it grows. A wrist over its
    fingers rises by the median of ``rises`` (F, 2), up to ``LEVEL_HAND_SINE``.
    """
    legs = np.broadcast_to(leg_rows(body, 0).sum(axis=1), len(track))
    standing, places, normals = np.zeros(len(track), dtype=np.bool_), track.copy(), np.zeros_like(track)
    heights = np.full(len(track), contact_height(body, point))
    for first, last in spans:
        span = slice(first, last + 1)
        small = legs[span] <= SMALL_BODY_RATIO * legs[span].min()
        middle = median_position(track[span][small])
        standing[span] = True
        if point.member == "hand":
            most = LEVEL_HAND_SINE * np.linalg.norm(_fingers(body, point.side))
            heights[span] += np.clip(np.median(rises[span, point.side]), 0.0, most)
        places[span], normals[span] = _place_on(middle, heights[first], ground)
    return GroundContact(point, standing, places, normals, heights)


def median_position(track: FloatArray) -> FloatArray:
    """Geometric median (2,) of the horizontal positions of a ``track`` (F, 3)."""
    return np.asarray(geometric_median(np.ascontiguousarray(track[:, :2])))


def _place_on(position: FloatArray, height: float, ground: Ground) -> tuple[FloatArray, FloatArray]:
    """Position (3,) at ``height`` metres above the ground at ``position`` (2,), and the ground's normal (3,)."""
    normal = ground.normal_at(position)
    return np.array([*position, ground.height_at(position)]) + height * normal, normal


def _fingers(body: AnyMorphology, side: int) -> FloatArray:
    """Vector (3,) in metres from the wrist to the finger tips, in the hand's axes."""
    return np.asarray(body.rows[0, measure.HAND + 3 * side : measure.HAND + 3 * side + 3])


def _bearing(body: AnyMorphology, ground: Ground, positions: FloatArray) -> FloatArray:
    """Load (2, F), 0 to 1, that each foot can carry if it stands: small for a lying leg on level ground."""
    knees = positions[:, [body.layout.hip_point(side) + 1 for side in range(2)], 2] - ground.height
    bearing = smoothstep_array(np.clip(knees.T / (LYING_KNEE_HEIGHT * body.leg_length) - 1.0, 0.0, 1.0))
    return bearing if ground.is_level else np.ones_like(bearing)


def _support_weights(
    standing: Mapping[ContactPoint, NDArray[np.bool_]],
    states: NDArray[np.int64],
    bearing: FloatArray,
    frame_rate: float,
) -> FloatArray:
    """Fractions (1 + H, F) of the body's weight on the feet, and on each of H contacts, smooth in time.

    They add up to 1 less the fraction of feet without load (``bearing`` (2, F)), by which the body keeps its position.
    A foot whose knee is in contact carries no load.
    """
    weights = np.zeros((2 + len(standing), states.shape[1]))
    kneeling = {point.side: stands for point, stands in standing.items() if point.member == "knee"}
    for side in range(2):
        stands = (states[side] != 0) & ~kneeling.get(side, np.zeros(states.shape[1], dtype=np.bool_))
        weights[:2] += stands * [bearing[side], 1.0 - bearing[side]]
    for row, stands in zip(weights[2:], standing.values(), strict=True):
        row += stands
    total = weights.sum(axis=0)
    frames, carried = np.arange(len(total)), np.flatnonzero(total > 0.0)
    fractions = np.array(
        [np.interp(frames, carried, row[carried] / total[carried]) for row in np.delete(weights, 1, 0)]
    )
    return np.asarray(hann_average(fractions.T, RELEASE_SECONDS, frame_rate).T)


def raise_by_swinging(wrists: FloatArray, shoulders: FloatArray, raises: FloatArray) -> FloatArray:
    """``wrists`` (F, 3) raised by ``raises`` (F,) metres: arms swing about their ``shoulders`` (F, 3) rather than bend.

    The sum of the squared swing and ``ARM_STIFFNESS`` times the squared shortening is least.
    """
    arms = wrists - shoulders
    lengths = np.maximum(np.linalg.norm(arms, axis=1), 1e-9)
    down = arms[:, 2] / lengths
    shortened = raises * down / np.maximum(ARM_STIFFNESS * (1.0 - down**2) + down**2, 1e-9)
    heights = arms[:, 2] + raises
    away = np.sqrt(np.maximum((lengths + shortened) ** 2 - heights**2, 0.0))
    aside = np.maximum(np.linalg.norm(arms[:, :2], axis=1), 1e-9)
    return np.asarray(shoulders + np.column_stack([arms[:, :2] * (away / aside)[:, None], heights]))


def reach_of(motion: NormalizedMotion, body: AnyMorphology, side: int) -> FloatArray:
    """Greatest free extension (F,) in metres of an arm in contact: its extension in the motion, or nearly straight."""
    own = np.clip(1.0 - motion.channels[:, channel.LIMB_SLACK + side], SOLE_SOFT_IK_THRESHOLD, 1.0 - 1e-9)
    return np.asarray(own * arm_rows(body, side).sum(axis=1))


def level_hands(hold: GroundContact, body: AnyMorphology, hands: FloatArray, frame_rate: float) -> FloatArray:
    """World rotations (F, 3, 3) of a hand with one orientation through each contact, laid on the ground.

    Fingers that point into the ground, or little above it, are laid on it, sloping down from a high wrist; so is a palm
    that faces down. Other hands (a fist, the back of a hand) keep their orientation. ``hands`` (F, 3, 3) as retargeted.
    """
    corrections = np.zeros((len(hands), 3))
    side = hold.point.side
    fingers = _fingers(body, side)
    length = float(np.linalg.norm(fingers))
    palm = np.array([1.0 - 2.0 * side, 0.0, 0.0])
    for first, past in runs_of(hold.standing):
        usual = Rotation.from_matrix(hands[first:past]).mean().as_matrix()
        slope = (hold.heights[first] - contact_height(body, hold.point)) / length
        laid = _laid(usual, fingers / length, palm, hold.normals[first], slope)
        corrections[first:past] = Rotation.from_matrix(laid @ np.swapaxes(hands[first:past], 1, 2)).as_rotvec()
    return np.asarray(
        Rotation.from_rotvec(interpolated_corrections(corrections, hold.standing, frame_rate)).as_matrix() @ hands
    )


def _laid(hand: FloatArray, fingers: FloatArray, palm: FloatArray, normal: FloatArray, slope: float) -> FloatArray:
    """Rotation (3, 3) of a hand laid on the plane of ``normal``, or inclined to it by the sine ``slope``.

    ``fingers`` and ``palm`` (3,) are directions in the hand's axes.
    """
    along, back = hand @ fingers, -(hand @ palm)
    rise = along @ normal
    ahead = along - rise * normal + (0.3 if rise < 0.0 else 0.0) * (back - (back @ normal) * normal)
    flat = normalized(ahead) if np.linalg.norm(ahead) > 1e-6 else normalized(np.cross(normal, back))
    normal, flat = np.sqrt(1.0 - slope**2) * normal + slope * flat, np.sqrt(1.0 - slope**2) * flat - slope * normal
    if rise < LEVEL_HAND_SINE:
        hand = shortest_arc(along, flat) @ hand
    looks = hand @ palm
    across = looks - (looks @ flat) * flat
    if -across @ normal > LEVEL_HAND_SINE:
        hand = shortest_arc(normalized(across), -normal) @ hand
    return hand
