"""Settling of a body on all its contacts: the root is moved until they are in reach, then knees and hands are
placed.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.morphology import AnyMorphology, arm_rows, leg_rows, sole_rows
from studio.core.captures.contacts import ContactPoint
from studio.core.grounds.ground import Ground
from studio.core.kernels import channel_columns as channel
from studio.core.kernels import measure_columns as measure
from studio.core.kernels import records
from studio.core.kernels.limbs.legs import knee_swivels, write_knee_targets
from studio.core.kernels.limbs.limb import MAX_EXTENSION, SOFT_IK_THRESHOLD
from studio.core.kernels.support.body_settling import move_bodies, settle_frames
from studio.core.kernels.support.sole import HEEL_STANDS, TOE_STANDS
from studio.core.kernels.support.swing_foot_clearance import raise_swing_foot
from studio.core.normalized.motion import NormalizedMotion
from studio.core.rotations import normalized, shortest_arc
from studio.core.runs import runs_of
from studio.core.solver.grounding.body_support import BodySupport, GroundContact, level_hands, reach_of, track_of
from studio.core.solver.grounding.contact_blending import (
    RELEASE_SECONDS,
    ROOT_AVERAGE_SECONDS,
    SLOW_RELEASE_SECONDS,
    hann_average,
    interpolated_corrections,
    release_weight,
    smooth_penetrations,
    smoothstep_array,
)
from studio.core.solver.grounding.footing import Footing, reach_relaxation
from studio.core.solver.grounding.footprints import tilts_of
from studio.core.solver.grounding.swing_foot_path import SOLE_TOLERANCE

FloatArray = NDArray[np.float64]

SOFT_TRAVEL_COST, FIRM_TRAVEL_COST = 1e-2, 1e-4
"""Cost of a metre of the body's travel, relative to a metre out of reach: while moves are averaged over time, and in
the last, exact move.
"""
KNEE_TOLERANCE_FRACTION = 0.1
"""Difference from its thigh's length that a released knee may have, as a fraction of the root's additional reach."""
LEAST_LEG_REACH = 0.18
"""Least distance hip-ankle, in leg lengths, of a leg with flesh, unless the actor's is folded further."""
FOLDED_MARGIN_FRACTION = 0.01
"""Least distance of a limb's ends beyond the distance at which it is completely folded, as a fraction of its length."""
CONTACT_MOVES = 5
"""Iterations of moving contacts that the body cannot reach."""
SETTLING_ROUNDS = 4
"""Number of moves that are averaged over time before the last, exact move."""


@dataclass(frozen=True, eq=False)
class ArmStance:
    """Targets of arms in contact with the ground, in all frames."""

    wrists: FloatArray
    """(2, F, 3) metres."""
    hands: FloatArray
    """(2, F, 3, 3) in the world."""
    bends: FloatArray
    """(2, F) sign of the side to which the elbow bends."""
    soft_thresholds: FloatArray
    """(2, F) soft-IK thresholds, fractions of the arm's length, 0 for an arm without target."""
    standing: NDArray[np.bool_]
    """(2, F) True in contact."""


@dataclass(frozen=True, eq=False)
class _Links:
    """Limbs as links between body and contacts, for ``settle_frames``."""

    starts: list[FloatArray]
    """(F, 3) shoulder, or hip, of each link, from the root."""
    ends: list[FloatArray]
    """(F, 3) wrist, ankle or knee of each link."""
    min_lengths: list[FloatArray]
    """(F,) least length of each link, metres."""
    max_lengths: list[FloatArray]
    """(F,) greatest length of each link, metres."""

    def add(self, start: FloatArray, end: FloatArray, least: FloatArray | float, most: FloatArray) -> None:
        """Add a link from ``start`` to ``end`` (F, 3) with the least and the greatest length in metres."""
        self.starts.append(start)
        self.ends.append(end)
        self.min_lengths.append(np.broadcast_to(least, most.shape))
        self.max_lengths.append(most)


def settle_on_contacts(
    carrying: BodySupport,
    footing: Footing,
    motion: NormalizedMotion,
    body: AnyMorphology,
    ground: Ground,
    positions: FloatArray,
    rotations: FloatArray,
) -> tuple[Footing, ArmStance, tuple[GroundContact, ...]]:
    """Lower, move and rotate a displaced body (F, P, 3), (F, S, 3, 3), in place, until all contacts are in reach.

    Returns the footing without root lowering, whose ankle targets (2, F, 7) have knee targets where knees are in
    contact, the arms in contact, and the contacts, moved to where the body reaches them.
    """
    positions[:, :, 2] -= footing.drops[:, None]
    level = replace(footing, drops=np.zeros_like(footing.drops))
    holds = {hold.point: hold for hold in carrying.holds}
    for _ in range(CONTACT_MOVES):
        footing, moves = _settled(holds, level, motion, body, ground, positions)
        places, rotation_matrices = positions.copy(), rotations.copy()
        move_bodies(moves, places, rotation_matrices)
        holds, kept = within_reach(holds, level, motion, body, ground, places), holds
        if all(holds[point] is kept[point] for point in holds):
            break
    positions[:], rotations[:] = places, rotation_matrices
    for hold in _kneeling_of(kept):
        _let_go_of_knees(hold, footing, motion, body, positions, rotations)
    return footing, _arms(kept, motion, body, positions, rotations), tuple(kept.values())


def _kneeling_of(holds: dict[ContactPoint, GroundContact]) -> list[GroundContact]:
    """Contacts of the knees."""
    return [holds[point] for point in (ContactPoint.LEFT_KNEE, ContactPoint.RIGHT_KNEE) if point in holds]


def _settled(
    holds: dict[ContactPoint, GroundContact],
    footing: Footing,
    motion: NormalizedMotion,
    body: AnyMorphology,
    ground: Ground,
    positions: FloatArray,
) -> tuple[Footing, FloatArray]:
    """Footing with knees in contact, and moves (F, 6) that bring the body into reach of its contacts."""
    rate, layout = motion.frame_rate, body.layout
    roots = np.ascontiguousarray(positions[:, 0])
    if ContactPoint.SEAT in holds:
        seated = 1.0 - release_weight(holds[ContactPoint.SEAT].standing, rate)
        footing = replace(footing, soft_thresholds=_relaxed_thresholds(footing.soft_thresholds, seated))
    kneeling = _kneeling_of(holds)
    if kneeling:
        footing = _kneeling(kneeling, footing, motion, body, ground, positions)
    links = _Links([], [], [], [])
    for side, root_reach in enumerate(footing.root_reaches):
        hip, legs = positions[:, layout.hip_point(side)], leg_rows(body, side)
        folded = np.minimum(1.0 - motion.channels[:, channel.LIMB_SLACK + 2 + side], LEAST_LEG_REACH) * legs.sum(axis=1)
        least = np.maximum(_shortest(legs), folded)
        links.add(hip - roots, footing.ankles[side, :, :3], least, root_reach * legs.sum(axis=1))
        if footing.ankles.shape[2] > 3:
            knee, firm = footing.ankles[side, :, 3:6], footing.ankles[side, :, 6]
            play = KNEE_TOLERANCE_FRACTION * reach_relaxation(1.0 - firm) * legs.sum(axis=1)
            links.add(hip - roots, knee, legs[:, 0] - play, legs[:, 0] + play)
    for side, point in enumerate((ContactPoint.LEFT_HAND, ContactPoint.RIGHT_HAND)):
        if point in holds:
            free, shoulder = (
                release_weight(holds[point].standing, rate, RELEASE_SECONDS),
                positions[:, layout.wrist_point(side) - 2],
            )
            arms = arm_rows(body, side)
            reach = reach_of(motion, body, side) + reach_relaxation(free) * arms.sum(axis=1)
            wrists = holds[point].displaced(track_of(point, body, positions), rate)
            links.add(shoulder - roots, wrists, _shortest(arms), reach)
    return footing, _moves(roots, links, _seats(holds.get(ContactPoint.SEAT), body, rate, positions), rate)


def _shortest(lengths: FloatArray) -> FloatArray:
    """Least distance (F or 1,) in metres of a folded limb's ends, for bones of ``lengths`` (F or 1, 2)."""
    return np.asarray(np.abs(lengths[:, 0] - lengths[:, 1]) + FOLDED_MARGIN_FRACTION * lengths.sum(axis=1))


def within_reach(
    holds: dict[ContactPoint, GroundContact],
    footing: Footing,
    motion: NormalizedMotion,
    body: AnyMorphology,
    ground: Ground,
    positions: FloatArray,
) -> dict[ContactPoint, GroundContact]:
    """Contacts of a settled body, moved along the ground to where they are in reach.

    ``positions`` (F, P, 3); ``footing`` is that without knees in contact.
    """
    moved = {}
    for point, hold in holds.items():
        if point is ContactPoint.SEAT:
            residual = track_of(point, body, positions) - hold.places
        elif point.member == "hand":
            arms = arm_rows(body, point.side)
            shoulders = positions[:, body.layout.wrist_point(point.side) - 2]
            residual = _too_far(hold.places, shoulders, _shortest(arms), reach_of(motion, body, point.side))
        else:
            residual = _knee_displacements(hold, footing, body, positions)
        moved[point] = hold.moved(residual, ground)
    return moved


def _knee_displacements(
    hold: GroundContact, footing: Footing, body: AnyMorphology, positions: FloatArray
) -> FloatArray:
    """Displacements (F, 3) of knees in contact to their bones' lengths from hips, and within reach of standing toes.

    A foot that lies in line with its shank stays so: shorter by a millimetre, its ankle would be off by centimetres.
    """
    side = hold.point.side
    legs = leg_rows(body, side)
    residual = _too_far(hold.places, positions[:, body.layout.hip_point(side)], legs[:, 0], legs[:, 0])
    to_toe = body.rows[:, measure.FOOT + 3 * side :][:, :3]
    bones = np.column_stack(np.broadcast_arrays(legs[:, 1], np.linalg.norm(to_toe, axis=1)))
    turned = np.einsum("fij,fj->fi", footing.feet[side], np.broadcast_to(to_toe, hold.places.shape))
    knee, toe = (positions[:, body.layout.hip_point(side) + k] for k in (1, 3))
    apart, both = np.linalg.norm(toe - knee, axis=1), hold.standing & (footing.states[side] == TOE_STANDS)
    for first, past in runs_of(both):
        apart[first:past] = np.median(apart[first:past])
    most = np.maximum(apart, (1.0 - FOLDED_MARGIN_FRACTION) * bones.sum(axis=1))
    shin = _too_far(hold.places, footing.ankles[side] + turned, _shortest(bones), most)
    return residual + np.where(both[:, None], shin, 0.0)


def _too_far(ends: FloatArray, starts: FloatArray, least: FloatArray, most: FloatArray) -> FloatArray:
    """Shortest displacements (F, 3) of ``ends`` (F, 3) after which they are ``least`` to ``most`` metres from
    ``starts``.
    """
    displacement = starts - ends
    span = np.maximum(np.linalg.norm(displacement, axis=1), 1e-9)
    over = np.maximum(span - most, 0.0) + np.minimum(span - least, 0.0)
    return np.asarray(displacement * (over / span)[:, None])


def _moves(roots: FloatArray, links: _Links, seats: FloatArray, frame_rate: float) -> FloatArray:
    """Moves (F, 6) of the body, translation and rotation vector: repeatedly averaged over time, then exact."""
    moves, centres = np.zeros((len(roots), 6)), np.zeros((len(roots), 6))
    known = records.SupportLinks(
        *(np.ascontiguousarray(each) for each in (links.starts, links.ends, links.min_lengths, links.max_lengths))
    )
    for _ in range(SETTLING_ROUNDS):
        settle_frames(roots, known, seats, centres, SOFT_TRAVEL_COST, moves)
        centres = hann_average(moves, ROOT_AVERAGE_SECONDS, frame_rate)
    settle_frames(roots, known, seats, centres, FIRM_TRAVEL_COST, moves)
    return moves


def _seats(hold: GroundContact | None, body: AnyMorphology, frame_rate: float, positions: FloatArray) -> FloatArray:
    """Seat targets (F, 7): middle of the hips relative to the root, its target, and the weight of its contact."""
    middle = track_of(ContactPoint.SEAT, body, positions)
    if hold is None:
        return np.column_stack([middle - positions[:, 0], middle, np.zeros(len(middle))])
    firm = 1.0 - release_weight(hold.standing, frame_rate, SLOW_RELEASE_SECONDS)
    return np.column_stack([middle - positions[:, 0], hold.displaced(middle, frame_rate), firm])


def _kneeling(
    holds: list[GroundContact],
    footing: Footing,
    motion: NormalizedMotion,
    body: AnyMorphology,
    ground: Ground,
    positions: FloatArray,
) -> Footing:
    """Footing with knees in contact: ankle targets (2, F, 7) with knees and their weights; shanks keep their lengths.

    With the knee alone in contact the foot follows; with the toe as well, the foot rotates about the toe; with the heel
    as well, the knee yields.
    """
    frame_rate = motion.frame_rate
    ankles = np.concatenate([footing.ankles, np.zeros((*footing.ankles.shape[:2], 4))], axis=2)
    feet, toes, soft_thresholds = footing.feet.copy(), footing.toes.copy(), footing.soft_thresholds.copy()
    for hold in holds:
        side = hold.point.side
        firm = (1.0 - release_weight(hold.standing, frame_rate, RELEASE_SECONDS))[:, None]
        knees = hold.displaced(track_of(hold.point, body, positions), frame_rate)
        shank = leg_rows(body, side)[:, 1:]
        to_toe = np.einsum(
            "fij,fj->fi", feet[side], np.broadcast_to(body.rows[:, measure.FOOT + 3 * side :][:, :3], knees.shape)
        )
        heel, toe = (
            1.0 - release_weight((footing.states[side] & bit) != 0, frame_rate)[:, None]
            for bit in (HEEL_STANDS, TOE_STANDS)
        )
        soles, states = sole_rows(body, side), footing.states[side]
        ankle = footing.ankles[side] + _off_its_instep(footing.ankles[side], feet[side], toes[side], soles, ground)
        tip, length = ankle + to_toe, np.linalg.norm(to_toe, axis=1, keepdims=True)
        knees = knees + firm * heel * (ankle + shank * normalized(knees - ankle) - knees)
        free, stands = knees + shank * normalized(ankle - knees), hold.standing & ((states & TOE_STANDS) != 0)
        pinned = np.where(stands[:, None], _on_both(knees, shank, tip, length, ankle) - free, 0.0)
        shin = normalized(free + interpolated_corrections(pinned, stands, frame_rate) - knees)
        placed = ankle + firm * (knees + shank * shin - ankle)
        by_toe = toe * (1.0 - firm) / np.maximum(toe * (1.0 - firm) + firm * (1.0 - toe), 1e-9)
        placed = placed + by_toe * (tip + length * normalized(placed - tip) - placed)
        turned = normalized(tip - ankle - toe * (placed - ankle))
        feet[side] = shortest_arc(normalized(to_toe), turned) @ feet[side]
        raised = _kept_above(placed, feet[side], toes[side], soles, states, ground, frame_rate)
        swung = shank * (normalized(raised - knees) - normalized(placed - knees))
        placed = raised + firm * (placed + swung - raised)
        ankles[side] = np.concatenate([placed, knees, firm], axis=1)
        soft_thresholds[side] = _relaxed_thresholds(soft_thresholds[side], firm[:, 0])
    return replace(footing, ankles=ankles, feet=feet, toes=toes, soft_thresholds=soft_thresholds)


def _let_go_of_knees(
    hold: GroundContact,
    footing: Footing,
    motion: NormalizedMotion,
    body: AnyMorphology,
    positions: FloatArray,
    rotations: FloatArray,
) -> None:
    """Swivel knees of a settled body to their contacts, interpolated before and after, in the ankle targets of
    ``footing``.
    """
    side = hold.point.side
    ankles, soft_thresholds = footing.ankles[side], footing.soft_thresholds[side]
    hips, pelvises = np.ascontiguousarray(positions[:, body.layout.hip_point(side)]), rotations[:, 0]
    leg = motion.channels, body.rows, side, soft_thresholds
    angles = np.zeros((motion.frame_count, 3))
    knee_swivels(*leg, ankles, hips, pelvises, angles[:, 0])
    for first, past in runs_of(hold.standing):
        whole = np.unwrap(angles[first:past, 0])
        angles[first:past, 0] = whole - 2.0 * np.pi * np.round(np.median(whole) / (2.0 * np.pi))
    free = interpolated_corrections(np.where(hold.standing[:, None], angles, 0.0), hold.standing, motion.frame_rate)[
        :, 0
    ]
    standing = ankles[hold.standing]
    write_knee_targets(*leg, free, hips, pelvises, ankles)
    ankles[hold.standing] = standing


def _kept_above(
    ankles: FloatArray,
    feet: FloatArray,
    toes: FloatArray,
    soles: FloatArray,
    states: NDArray[np.int64],
    ground: Ground,
    frame_rate: float,
) -> FloatArray:
    """Ankles (F, 3) of a kneeling body, raised above the plane of the ground; ``toes`` are bent up in place."""
    under = np.column_stack(
        [ankles[:, :2], hann_average(ground.height_at(ankles)[:, None], ROOT_AVERAGE_SECONDS, frame_rate)]
    )
    tilts = hann_average(tilts_of(ground.normal_at(ankles)), ROOT_AVERAGE_SECONDS, frame_rate)
    rotation_matrices = Rotation.from_rotvec(tilts).as_matrix()
    back = np.swapaxes(rotation_matrices, 1, 2)
    places, bent = np.einsum("fij,fj->fi", back, ankles - under), back @ toes
    raise_swing_foot(soles, states, 0.0, frame_rate, places, back @ feet, bent)
    toes[:] = rotation_matrices @ bent
    raised = under + np.einsum("fij,fj->fi", rotation_matrices, places)
    flying = states[:, None] == 0
    return np.asarray(raised + np.where(flying, _off_its_instep(raised, feet, toes, soles, ground), 0.0))


def _off_its_instep(
    ankles: FloatArray, feet: FloatArray, toes: FloatArray, soles: FloatArray, ground: Ground
) -> FloatArray:
    """Displacements (F, 3) of feet whose soles are up, which clear their toes of the ground. METHOD (7)."""
    forward, left, down, height, _, length = np.broadcast_to(soles, (len(feet), 6)).T
    joint = ankles + np.einsum("fij,fj->fi", feet, np.column_stack([forward, left, down]))
    tip = joint + np.einsum("fij,fj->fi", toes, np.column_stack([length, 0.0 * length, -height - down]))
    normals = ground.normal_at(joint)
    above = (tip[:, 2] - ground.height_at(tip)) * normals[:, 2]
    upside = smoothstep_array(np.clip(-8.0 * np.einsum("fk,fk->f", feet[..., 2], normals), 0.0, 1.0))
    return np.asarray((upside * smooth_penetrations(above, SOLE_TOLERANCE))[:, None] * normals)


def _relaxed_thresholds(soft_thresholds: FloatArray, fraction: FloatArray) -> FloatArray:
    """Soft-IK thresholds relaxed by ``fraction`` towards a straight leg, for legs without load."""
    return np.asarray(soft_thresholds + fraction * np.maximum(MAX_EXTENSION - soft_thresholds, 0.0))


def _on_both(
    first: FloatArray, first_radius: FloatArray, second: FloatArray, second_radius: FloatArray, target: FloatArray
) -> FloatArray:
    """Points (F, 3) at given distances from two points, nearest to ``target``; on the line between these if there are
    none.
    """
    line = second - first
    apart = np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-9)
    along = line / apart
    fraction = (apart**2 + first_radius**2 - second_radius**2) / (2.0 * apart)
    middle = first + fraction * along
    radius = np.sqrt(np.maximum(first_radius**2 - fraction**2, 0.0))
    away = target - middle
    away = away - np.sum(away * along, axis=1, keepdims=True) * along
    return np.asarray(middle + radius * normalized(away))


def _arms(
    holds: dict[ContactPoint, GroundContact],
    motion: NormalizedMotion,
    body: AnyMorphology,
    positions: FloatArray,
    rotations: FloatArray,
) -> ArmStance:
    """Targets of arms in contact, for a settled body."""
    layout, count = body.layout, len(positions)
    soft_thresholds, standing = np.zeros((2, count)), np.zeros((2, count), dtype=np.bool_)
    wrists = np.stack([positions[:, layout.wrist_point(side)] for side in range(2)])
    hands = np.stack([rotations[:, layout.hand_segment(side)] for side in range(2)])
    bends = np.ones((2, count))
    for side, point in enumerate((ContactPoint.LEFT_HAND, ContactPoint.RIGHT_HAND)):
        if point not in holds:
            continue
        hold = holds[point]
        own, standing[side] = wrists[side].copy(), hold.standing
        wrists[side] = hold.displaced(own, motion.frame_rate)
        hands[side] = level_hands(hold, body, hands[side], motion.frame_rate)
        placed = hold.standing | (wrists[side] != own).any(axis=1)
        free = release_weight(hold.standing, motion.frame_rate) * release_weight(~placed, motion.frame_rate)
        stretch = reach_of(motion, body, side) / arm_rows(body, side).sum(axis=1)
        soft_thresholds[side] = np.where(placed, stretch - free * np.maximum(stretch - SOFT_IK_THRESHOLD, 0.0), 0.0)
        for first, past in runs_of(placed):
            bends[side, first:past] = (
                1.0 if motion.channels[first:past, channel.LIMB_BEND + side].sum() >= 0.0 else -1.0
            )
    return ArmStance(wrists, hands, bends, soft_thresholds, standing)
