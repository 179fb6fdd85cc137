"""Self-collision constraints of the arms as arrays for ``kernels.limits.arm_clearance``."""

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.constraints.base import Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.kernels.limits import arm_clearance as kernel
from studio.core.kernels.limits.self_collision import TASK_ABOVE, TASK_BELOW, TASK_BESIDE, TASK_IS_CONTACT
from studio.core.kernels.records import CapsuleArrays, ClearanceArrays
from studio.core.mesh.volume import ARM_PROBES, BodyVolume, usual_volume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.core.project_cache import project_cache
from studio.core.solver.request import AdaptedMotion

if TYPE_CHECKING:
    from studio.core.solver.grounding.grounded_motion import GroundedMotion

FloatArray = NDArray[np.float64]


def lowest_first(constraints: Sequence[Constraint]) -> list[int]:
    """Indices of the self-collision constraints among ``constraints``, the highest priority last."""
    clear = [(row, each) for row, each in enumerate(constraints) if isinstance(each, ClearConstraint)]
    clear.sort(key=lambda pair: (-pair[1].priority, pair[1].margin, pair[1].arms, pair[1].name))
    return [row for row, _ in clear]


def pack_clearance(
    clears: Sequence[Constraint],
    others: Sequence[Constraint],
    held: int,
    activations: FloatArray,
    misses: FloatArray,
    standing: "GroundedMotion",
    window: slice,
) -> ClearanceArrays:
    """``ClearanceArrays`` of Q self-collision constraints for the kernels, which write residuals into ``misses`` (Q,
    F).

    ``activations`` (Q, F) in the ``window`` of frames. The first ``held`` of the ``others`` are contacts and have a
    higher level, as do those of the same or a higher priority. Without a known actor, no clearance is inherited;
    without a volume of the body, the typical one is used.
    """
    if not clears:
        return _no_clearance(len(others))
    shape = (activations.shape[1], 2, len(ARM_PROBES))
    own, displacements = np.zeros(shape), np.zeros((*shape, 3))
    if standing.actor is not None:
        actor_has = actor_clearances(standing.motion, standing.actor)
        own, displacements = (np.ascontiguousarray(each[window]) for each in actor_has)
    asked = [each for each in clears if isinstance(each, ClearConstraint)]
    target = np.empty((len(asked), *shape))
    above = np.full((len(asked), len(others)), TASK_IS_CONTACT)
    priorities = np.array([each.priority for each in others[held:]], dtype=np.int64)
    for row, each in enumerate(asked):
        kernel.required_distances(own, each.margin, target[row])
        beside = np.where(priorities == each.priority, TASK_BESIDE, TASK_BELOW)
        above[row, held:] = np.where(priorities < each.priority, TASK_ABOVE, beside)
    body = standing.morphology.first_frame_body
    return ClearanceArrays(
        packed_volume(standing.volume or usual_volume(body)),
        np.array(body.layout.proximal_points()),
        target,
        np.ascontiguousarray(activations),
        np.array([[float(each.arms.has(side)) for side in range(2)] for each in asked]).reshape(-1, 2),
        np.array([each.chain.limb for each in asked], dtype=np.float64),
        above,
        misses,
        own,
        displacements,
        _tiers([each.priority for each in asked], np.concatenate([np.full(held, -1), priorities])),
    )


def _tiers(clears: list[int], others: NDArray[np.int64]) -> NDArray[np.int64]:
    """Priority tier of each of ``clears`` and ``others``, given their priorities: 0 down to the highest of ``clears``,
    then one each.
    """
    priorities = np.maximum(np.concatenate([clears, others]), min(clears))
    return np.asarray(np.searchsorted(np.unique(priorities), priorities), dtype=np.int64)


def activations_by_tier(activations: FloatArray, clearance: ClearanceArrays) -> FloatArray:
    """Activations (K, C, F) of the tasks down to each of K priority tiers, from ``activations`` (C, F)."""
    tiers = clearance.tiers
    others = tiers[len(tiers) - len(activations) :]
    return np.where(others[:, None] <= np.arange(tiers.max() + 1)[:, None, None], activations, 0.0)


@cache
def _no_clearance(others: int) -> ClearanceArrays:
    """``ClearanceArrays`` without self-collision constraints, for a number of ``others``."""
    volume = BodyVolume(np.empty((0, 2), np.int64), np.empty((0, 2, 3)), np.empty((0, 2)), np.empty(0))
    none, clearances = np.empty((0, 0)), np.empty((0, 2, len(ARM_PROBES)))
    above = np.empty((0, others), np.int64)
    target, displacements, tiers = (
        np.empty((0, *clearances.shape)),
        np.empty((*clearances.shape, 3)),
        np.zeros(others, np.int64),
    )
    arms, freedoms = np.empty((0, 2)), np.empty(0)
    return ClearanceArrays(
        packed_volume(volume), tiers[:0], target, none, arms, freedoms, above, none, clearances, displacements, tiers
    )


def arm_distances(adapted: AdaptedMotion) -> FloatArray:
    """Signed distances (F, 2, 5) in metres of both arms' probes from the body, negative inside."""
    volume = adapted.volume or usual_volume(adapted.morphology)
    return clearances_of(adapted.morphology, volume, adapted.positions[:], adapted.rotations[:])[0]


@project_cache(maxsize=8)
def actor_clearances(motion: NormalizedMotion, actor: Morphology) -> tuple[FloatArray, FloatArray]:
    """Signed distances (F, 2, 5) in metres of the captured actor's arms from its body, and outward directions (F, 2, 5,
    3).
    """
    return clearances_of(actor, usual_volume(actor), *realize_motion(motion, actor, play=True))


@project_cache(maxsize=64)
def rest_clearances(body: Morphology, volume: BodyVolume) -> FloatArray:
    """Signed distances (2, 5) in metres of a body's arms in its rest pose, where a thick arm may be inside."""
    positions, rotations = rest_pose(body)
    found, _ = clearances_of(body, volume, positions[None], rotations[None])
    return np.asarray(found[0])


def clearances_of(
    body: AnyMorphology, volume: BodyVolume, positions: FloatArray, rotations: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Signed distances (F, 2, 5) of the arms of posed frames (F, P, 3), (F, S, 3, 3), and outward directions (F, 2, 5,
    3).
    """
    found = np.empty((len(positions), 2, len(ARM_PROBES)))
    displacements = np.empty((*found.shape, 3))
    kernel.measure_clip_distances(
        packed_volume(volume), np.array(body.layout.proximal_points()), positions, rotations, found, displacements
    )
    return found, displacements


def packed_volume(volume: BodyVolume) -> CapsuleArrays:
    """``CapsuleArrays`` of a body volume for the kernels."""
    return CapsuleArrays(volume.segments, volume.places, volume.radii, volume.girths)
