"""Adaptation: scale the motion to a body, set it on the ground, solve its constraints, in one call a clip."""

from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.balance import Support
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.follow import Follow, FollowBody
from studio.core.constraints.target import follows_of
from studio.core.contacts import ContactInterval
from studio.core.errors import StudioError
from studio.core.ground import Ground
from studio.core.joint_limits import limits_of
from studio.core.kernels.adapt import place_frames, solve_frames
from studio.core.kernels.carrying import place_arms
from studio.core.morphology import AnimatedMorphology, AnyMorphology, Morphology, at_frames
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize
from studio.core.solver.carrying import Hold, find_carrying, limb_freedom
from studio.core.solver.chains import free_joints, segment_masses
from studio.core.solver.clearance import lowest_first, pack_clearance
from studio.core.solver.footing import Footing, find_footing, leashes
from studio.core.solver.holding import held_points, place_above, release_hands
from studio.core.solver.packing import in_order, limb_of, pack, point_indices, share_by_weight
from studio.core.solver.recruiting import find_recruits, leg_room, limb_freedoms
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.settling import Arms, settle
from studio.core.solver.support import mass_path, standing_points, support_path
from studio.core.solver.tracks import Targets, Track, Tracks
from studio.core.volume import BodyVolume

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Standing:
    """A motion on one body and on the ground, before any constraint: what a dragged constraint need not ask again."""

    motion: NormalizedMotion
    morphology: AnyMorphology
    contacts: tuple[ContactInterval, ...]
    ground: Ground
    footing: Footing
    holds: tuple[Hold, ...]
    arms: Arms | None
    positions: FloatArray
    rotations: FloatArray
    volume: BodyVolume | None = None
    actor: Morphology | None = None
    limited: bool = True


@dataclass(frozen=True)
class Bound:
    """By what a body is bound beside its constraints."""

    by_contacts: bool = True
    by_limits: bool = True


def adapt(request: AdaptRequest, first: int = 0, last: int | None = None) -> AdaptedMotion:
    """The motion on the body of ``request``, frames ``first`` to ``last`` (both included, all by default).

    Every frame is solved from its own pose alone, so any window gives the same poses as the whole clip.
    """
    standing = standing_of(request)
    return hold(standing, request.constraints, first, last, request.tracks)


def standing_of(request: AdaptRequest) -> Standing:
    """How the motion of ``request`` stands before its constraints."""
    ground, volume, actor = request.ground, request.volume, request.actor
    return stand(request.motion, request.morphology, request.contacts, ground, volume, actor, request.limited)


def stand(
    motion: NormalizedMotion,
    morphology: AnyMorphology,
    contacts: Sequence[ContactInterval],
    ground: Ground,
    volume: BodyVolume | None = None,
    actor: Morphology | None = None,
    limited: bool = True,
) -> Standing:
    """Scale a motion to a body and set it on the ground: feet, and what else carries it (K05 sections 6 and 7)."""
    positions, rotations = realize(motion, morphology)
    if ground.height:
        positions[:, :, 2] += ground.height
    carrying = find_carrying(motion, morphology, contacts, ground, positions, rotations)
    upright, share = (positions, rotations), 1.0 if carrying is None else carrying.feet_share
    if carrying is not None:
        positions += carrying.shift[:, None]
        if not ground.is_level:  # feet keep their heights above it
            upright = carrying.upright + carrying.shift[:, None] * [1.0, 1.0, 0.0], rotations
            positions, rotations = carrying.pose[0] + carrying.shift[:, None], carrying.pose[1]
    footing = find_footing(motion, morphology, contacts, ground, positions, rotations, share, upright)
    arms: Arms | None = None
    holds: tuple[Hold, ...] = ()
    if carrying is not None:
        footing, arms, holds = settle(carrying, footing, motion, morphology, ground, positions, rotations)
    measures, legs = morphology.rows, _legs(footing, slice(None))
    place_frames(motion.channels, measures, footing.drops, *legs, positions, rotations)
    if arms is not None:
        stance = arms.wrists, arms.hands, arms.bends, arms.comforts
        place_arms(motion.channels, measures, *stance, positions, rotations)
    known = tuple(contacts), ground
    return Standing(motion, morphology, *known, footing, holds, arms, positions, rotations, volume, actor, limited)


def hold(
    standing: Standing,
    constraints: Sequence[Constraint],
    first: int = 0,
    last: int | None = None,
    tracks: Tracks = MappingProxyType({}),
    *,
    bound: Bound = Bound(),
) -> AdaptedMotion:
    """Solve ``constraints`` on a standing motion, frames ``first`` to ``last`` (both included) (K05 section 9).

    ``tracks`` over the whole motion for all that they follow beyond the body itself; StudioError where one is missing.
    ``bound`` lets a report ask what would be without the feet's contacts or the joints' limits.
    """
    window = slice(first, standing.motion.frame_count if last is None else last + 1)
    positions, rotations = standing.positions[window], standing.rotations[window]  # theirs too where nothing is asked
    residuals = np.full((len(constraints), len(positions)), np.nan)
    if constraints:
        known = _known_tracks(standing, constraints, window, tracks)
        positions, rotations = positions.copy(), rotations.copy()
        _solve(standing, constraints, window, known, bound, residuals, positions, rotations)
    return _answer(standing, first, positions, rotations, residuals)


def _known_tracks(
    standing: Standing, constraints: Sequence[Constraint], window: slice, tracks: Tracks
) -> dict[Follow | Support, Track]:
    """What is followed and known before anything is solved, in the frames of ``window``."""
    known: dict[Follow | Support, Track] = {}
    for constraint in constraints:
        for follow in follows_of(constraint):
            if follow in tracks:
                known[follow] = tracks[follow].within(window)
            elif not isinstance(follow, FollowBody):
                raise StudioError(f"'{constraint.name}' follows something that is not there. Choose what it follows.")
        place = getattr(constraint, "place", None)
        if isinstance(place, Support):
            path = support_path(
                standing.positions, standing.rotations,
                standing_points(standing.contacts, standing.motion.frame_count), standing.morphology.still,
                standing.motion.frame_rate, place.margin, window,
            )  # fmt: skip
            known[place] = Track(path, np.broadcast_to(np.eye(3), (1, 3, 3)))
    return known


def _solve(
    standing: Standing,
    constraints: Sequence[Constraint],
    window: slice,
    tracks: Tracks,
    bound: Bound,
    residuals: FloatArray,
    positions: FloatArray,
    rotations: FloatArray,
) -> None:
    """One run of the kernel over ``window``, in place."""
    motion, body = standing.motion, standing.morphology
    times = np.arange(motion.frame_count)[window] / motion.frame_rate
    held = held_points(standing.holds, body, standing.positions, standing.rotations) if bound.by_contacts else []
    order, clear_rows = in_order(constraints), lowest_first(constraints)
    order = [c for c in order if c not in clear_rows]
    everything = [*(each.constraint for each in held), *(constraints[c] for c in order)]
    everywhere = constraint_activations(constraints, standing.contacts, motion)
    given = everywhere[:, window]
    activations = given[order]
    leash = (
        leashes(standing.footing, motion.frame_rate)[:, window]
        if bound.by_contacts
        else np.full((2, len(times)), np.inf)
    )
    rows = pack(everything, body.layout, Targets(times, tracks, lambda: mass_path(positions, body.still)))
    if held:
        place_above(rows, held, window)
        stands = np.array([each.standing[window] for each in held])
        activations = np.concatenate([stands & (given > 0.0).any(axis=0), activations])
    share_by_weight(rows)
    chains = tuple(constraint.chain for constraint in everything)
    joints = free_joints(chains, tuple(rows.asked["rank"].tolist()), body.layout)
    joints = joints if bound.by_limits else joints.without_limits
    limbs = rows.asked["ends"][len(held) :, :, 2]
    recruits = find_recruits(
        joints, body.layout.spine_count, lambda: _freedoms(standing, window, limbs, everywhere[order], bound)
    )
    clearance = pack_clearance(
        [constraints[c] for c in clear_rows], everything, len(held), given[clear_rows],
        motion, window, standing.actor, standing.volume, body.still,
    )  # fmt: skip
    limits = limits_of(body.still)[: 4 * (bound.by_limits and standing.limited)]
    misses = np.full((len(everything), len(positions)), np.nan)
    solve_frames(
        rows.asked,
        rows.areas,
        joints.arrays,
        recruits,
        rows.wishes,
        np.ascontiguousarray(activations, dtype=np.float64),
        np.ascontiguousarray(leash),
        (motion.channels[window], *_legs(standing.footing, window)),
        (at_frames(body.rows, window), segment_masses(body.layout), limits),
        clearance,
        positions.copy() if clear_rows else standing.positions[window],
        rotations.copy() if clear_rows else standing.rotations[window],
        misses,
        positions,
        rotations,
    )
    residuals[order] = misses[len(held) :]
    if clear_rows:
        residuals[clear_rows] = clearance[7]
    if standing.arms is not None:
        rate, channels = motion.frame_rate, motion.channels[window]
        release_hands(standing.arms, standing.holds, body, channels, rate, window, positions, rotations)


def _freedoms(
    standing: Standing, window: slice, limbs: NDArray[np.int64], activations: FloatArray, bound: Bound
) -> FloatArray:
    """(4, F) how far each limb is a balance's to turn; ``limbs`` (C, 2) of the wishes, ``activations`` (C, all)."""
    contacts = standing.contacts if bound.by_contacts else ()
    free = limb_freedoms(limbs, activations, contacts, standing.motion.frame_rate)[:, window]
    free[2:] *= leg_room(standing.morphology, standing.ground, standing.positions, window)
    return free


def _answer(
    standing: Standing, first: int, positions: FloatArray, rotations: FloatArray, residuals: FloatArray
) -> AdaptedMotion:
    body, rate = standing.morphology, standing.motion.frame_rate
    animated = body if isinstance(body, AnimatedMorphology) else None
    return AdaptedMotion(body.still, rate, first, positions, rotations, residuals, animated, standing.volume)


def _legs(footing: Footing, window: slice) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Comforts, ankles, feet and toes of a stretch of frames, as kernels want them: contiguous."""
    return (
        np.ascontiguousarray(footing.comforts[:, window]),
        np.ascontiguousarray(footing.ankles[:, window]),
        np.ascontiguousarray(footing.feet[:, window]),
        np.ascontiguousarray(footing.toes[:, window]),
    )


def constraint_activations(
    constraints: Sequence[Constraint], contacts: Sequence[ContactInterval], motion: NormalizedMotion
) -> FloatArray:
    """(C, F) in [0, 1]; a constraint on a limb yields to that limb's contacts, which stand above all."""
    times = np.arange(motion.frame_count) / motion.frame_rate
    return np.array(
        [
            constraint.activation.at(times)
            * limb_freedom(contacts, limb_of(constraint.point.part), motion.frame_count, motion.frame_rate)
            for constraint in constraints
        ]
    )


def place_of(point: BodyPoint, adapted: AdaptedMotion) -> FloatArray:
    """Where a body point is at every frame of an adapted motion, (F, 3) metres in the motion's space."""
    origin, segment = point_indices(point, adapted.morphology.layout)
    return np.asarray(adapted.positions[:, origin] + adapted.rotations[:, segment] @ np.array(point.offset))
