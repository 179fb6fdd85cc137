"""What keeps arms out of their own body, as arrays for ``kernels.limits.clearance``."""

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.constraints.base import Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.kernels.limits import clearance as kernel
from studio.core.kernels.limits.clearing import ABOVE, BELOW, BESIDE, CONTACT
from studio.core.kernels.records import Clearance, Volume
from studio.core.mesh.volume import PROBES, BodyVolume, usual_volume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize
from studio.core.project_cache import project_cache
from studio.core.solver.request import AdaptedMotion

if TYPE_CHECKING:
    from studio.core.solver.standing.stand import Standing

FloatArray = NDArray[np.float64]


def lowest_first(constraints: Sequence[Constraint]) -> list[int]:
    """Rows of the clear constraints, the highest last: it has the last word. Which was made first does not count."""
    clear = [(row, each) for row, each in enumerate(constraints) if isinstance(each, ClearConstraint)]
    clear.sort(key=lambda pair: (-pair[1].priority, pair[1].margin, pair[1].arms, pair[1].name))
    return [row for row, _ in clear]


def pack_clearance(
    clears: Sequence[Constraint],
    others: Sequence[Constraint],
    held: int,
    activations: FloatArray,
    misses: FloatArray,
    standing: "Standing",
    window: slice,
) -> Clearance:
    """What the kernels take of Q constraints, which write what is missed into ``misses`` (Q, F).

    ``activations`` (Q, F) in the ``window`` of frames. Above a clear constraint stand the first ``held`` of the
    others, which are contacts, and those of its priority or a higher one. Where no actor is known it is taken to
    touch itself all the time; where no volume is, it is what is usual.
    """
    if not clears:
        return _nothing(len(others))
    shape = (activations.shape[1], 2, len(PROBES))
    own, ways = np.zeros(shape), np.zeros((*shape, 3))
    if standing.actor is not None:
        actor_has = actor_rooms(standing.motion, standing.actor)
        own, ways = (np.ascontiguousarray(each[window]) for each in actor_has)
    asked = [each for each in clears if isinstance(each, ClearConstraint)]
    wanted = np.empty((len(asked), *shape))
    above = np.full((len(asked), len(others)), CONTACT)
    priorities = np.array([each.priority for each in others[held:]], dtype=np.int64)
    for row, each in enumerate(asked):
        kernel.wanted_rooms(own, each.margin, wanted[row])
        beside = np.where(priorities == each.priority, BESIDE, BELOW)
        above[row, held:] = np.where(priorities < each.priority, ABOVE, beside)
    body = standing.morphology.still
    return Clearance(
        packed(standing.volume or usual_volume(body)),
        np.array(body.layout.proximal_points()),
        wanted,
        np.ascontiguousarray(activations),
        np.array([[float(each.arms.has(side)) for side in range(2)] for each in asked]).reshape(-1, 2),
        np.array([each.chain.limb for each in asked], dtype=np.float64),
        above,
        misses,
        own,
        ways,
        _tiers([each.priority for each in asked], np.concatenate([np.full(held, -1), priorities])),
    )


def _tiers(clears: list[int], others: NDArray[np.int64]) -> NDArray[np.int64]:
    """Tiers of ``clearance_tiers`` by priorities: 0 down to the highest of ``clears``, then one each."""
    priorities = np.maximum(np.concatenate([clears, others]), min(clears))
    return np.asarray(np.searchsorted(np.unique(priorities), priorities), dtype=np.int64)


def down_to_tiers(activations: FloatArray, clearance: Clearance) -> FloatArray:
    """``activations`` (C, F) as the kernels take them, (K, C, F): of what stands down to each of K tiers."""
    tiers = clearance.tiers
    others = tiers[len(tiers) - len(activations) :]
    return np.where(others[:, None] <= np.arange(tiers.max() + 1)[:, None, None], activations, 0.0)


@cache
def _nothing(others: int) -> Clearance:
    """What the kernels take where nothing is asked to be clear of anything."""
    volume = BodyVolume(np.empty((0, 2), np.int64), np.empty((0, 2, 3)), np.empty((0, 2)), np.empty(0))
    none, rooms = np.empty((0, 0)), np.empty((0, 2, len(PROBES)))
    above = np.empty((0, others), np.int64)
    wanted, ways, tiers = np.empty((0, *rooms.shape)), np.empty((*rooms.shape, 3)), np.zeros(others, np.int64)
    arms, freedoms = np.empty((0, 2)), np.empty(0)
    return Clearance(packed(volume), tiers[:0], wanted, none, arms, freedoms, above, none, rooms, ways, tiers)


def rooms(adapted: AdaptedMotion) -> FloatArray:
    """(F, 2, 5) metres from the surface of each probe of both arms to that of the body, negative inside."""
    volume = adapted.volume or usual_volume(adapted.morphology)
    return rooms_of(adapted.morphology, volume, adapted.positions[:], adapted.rotations[:])[0]


@project_cache(maxsize=8)
def actor_rooms(motion: NormalizedMotion, actor: Morphology) -> tuple[FloatArray, FloatArray]:
    """``rooms`` of the actor that a motion was captured from, and the ways out of its body (F, 2, 5, 3)."""
    return rooms_of(actor, usual_volume(actor), *realize(motion, actor, play=True))


@project_cache(maxsize=64)
def rest_rooms(body: Morphology, volume: BodyVolume) -> FloatArray:
    """``rooms`` of a body in its rest pose, (2, 5): a thick arm may have none there."""
    positions, rotations = rest_pose(body)
    found, _ = rooms_of(body, volume, positions[None], rotations[None])
    return np.asarray(found[0])


def rooms_of(
    body: AnyMorphology, volume: BodyVolume, positions: FloatArray, rotations: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """``rooms`` of posed frames (F, P, 3), (F, S, 3, 3), and the ways out of the body (F, 2, 5, 3)."""
    found = np.empty((len(positions), 2, len(PROBES)))
    ways = np.empty((*found.shape, 3))
    kernel.room_frames(packed(volume), np.array(body.layout.proximal_points()), positions, rotations, found, ways)
    return found, ways


def packed(volume: BodyVolume) -> Volume:
    """A volume as the kernels take it."""
    return Volume(volume.segments, volume.places, volume.radii, volume.girths)
