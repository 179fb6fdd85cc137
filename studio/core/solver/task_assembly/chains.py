"""Joints that a constraint's chain may move, with their weights and limits, for ``kernels.search``."""

from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.base import CLAVICLES, THIGHS, UPPER_ARMS, Chain, Constraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.position import PositionConstraint
from studio.core.kernels import records
from studio.core.kernels.search.joints import ROOT_TRANSLATION, joint_table
from studio.core.solver.task_assembly.points import limb_of

FloatArray = NDArray[np.float64]

ROOT_WEIGHT = 0.15
"""Weight of the root's translation, in square metres, relative to that of one vertebra's rotation."""
JOINT_WEIGHTS = {**dict.fromkeys(CLAVICLES, 4.0), **dict.fromkeys(UPPER_ARMS, 30.0), **dict.fromkeys(THIGHS, 5.0)}
"""Weights of joints relative to a vertebra (METHOD 9). Those of shoulders and hips, for the redundant limbs of a
balance, are in proportion to the limbs' masses.
"""
VERTEBRA_LIMIT, CLAVICLE_LIMIT, NECK_LIMIT = 0.5, 0.35, 0.7
"""Greatest rotation of vertebrae, clavicles, neck and head away from the motion, in radians."""
SHOULDER_LIMIT, HIP_LIMIT = 0.7, 0.4
"""Greatest rotation of a redundant limb's shoulder or hip away from the motion, in radians."""


@dataclass(frozen=True, eq=False)
class ChainJoints:
    """Joints that at least one chain may move: N joints, C chains, L levels, S segments."""

    weights: FloatArray
    """(C + L, N) joint weights of each chain, then of each level together with all levels above it."""
    joints: NDArray[np.void]
    """(N,) records of ``SEARCH_JOINT``."""
    joint_of_segment: NDArray[np.int64]
    """(S + 1,) index of the joint of each segment, then that of the root's translation; -1 for none."""
    limits: FloatArray
    """(N,) tangent of half the greatest angle of each joint."""
    recruited: NDArray[np.int64]
    """(n,) indices of shoulders and hips among the joints."""
    limbs: NDArray[np.int64]
    """(n,) limb of each of these shoulders and hips."""

    @cached_property
    def nominal_weights(self) -> FloatArray:
        """Weights (C + L + 1, n) of the redundant limbs' joints at full availability, with their limits as last row."""
        return np.ascontiguousarray(np.vstack([self.weights, np.nan_to_num(self.limits)])[:, self.recruited])

    @property
    def kernel_weights(self) -> records.JointWeights:
        """Copy as a record for the kernels, which write the availability of limbs at a frame into it."""
        return records.JointWeights(self.weights.copy(), self.joints, self.joint_of_segment, self.limits.copy())

    @property
    def without_limits(self) -> "ChainJoints":
        """Copy without limits of the joints."""
        return replace(self, limits=np.full_like(self.limits, np.inf))


def relevant_chain(constraint: Constraint) -> Chain:
    """Chain of a constraint without joints that cannot help it: for a position on a limb, without the other
    clavicles.
    """
    alone = isinstance(constraint, PositionConstraint) and not isinstance(constraint.target, FollowBody)
    limb = limb_of(constraint.point.part)
    return _without_clavicles(constraint.chain, limb) if alone and limb >= 0 else constraint.chain


@lru_cache(maxsize=256)
def _without_clavicles(chain: Chain, limb: int) -> Chain:
    """Chain without weights of the clavicles, except that of ``limb`` and those that the chain names."""
    named = {part for part, _ in chain.segments}
    idle = [clavicle for side, clavicle in enumerate(CLAVICLES) if side != limb and clavicle not in named]
    return replace(chain, segments=(*chain.segments, *((clavicle, 0.0) for clavicle in idle)))


@lru_cache(maxsize=256)
def joints_of_chains(chains: tuple[Chain, ...], ranks: tuple[int, ...], layout: BodyLayout) -> ChainJoints:
    """Joints that ``chains`` free: pelvis, spine, clavicles, neck, head, redundant limbs and root translation.

    ``ranks`` (C,) are the levels of the chains' constraints.
    """
    k = layout.spine_count
    segments = np.array([*range(k), k + 2, k + 6, k, k + 1, k + 3, k + 7, k + 10, k + 14, ROOT_TRANSLATION])
    trunk = [*[VERTEBRA_LIMIT] * k, *[CLAVICLE_LIMIT] * 2, *[NECK_LIMIT] * 2]
    limits = [*trunk, *[SHOULDER_LIMIT] * 2, *[HIP_LIMIT] * 2, np.pi / 2]
    parts = [layout.part_of_segment(segment) for segment in segments[:-1]]
    usual = np.array([*(JOINT_WEIGHTS.get(part, 1.0) for part in parts), ROOT_WEIGHT])
    weights = (
        np.array([[*(_weight(chain, part) for part in parts), chain.root] for chain in chains]).reshape(
            -1, len(segments)
        )
        * usual
    )
    free = weights.any(axis=0)
    free[-1] |= free[0]  # a pelvis that turns must not pull the feet away: the root, freed by nobody, follows them
    of_level = [np.array(ranks) <= level for level in range(max(ranks, default=-1) + 1)]
    levels = [weights[down_to].max(axis=0) for down_to in of_level]
    slots = np.full(layout.segment_count + 1, -1)
    slots[segments[free]] = np.arange(free.sum())
    of_limbs = np.arange(4) + len(segments) - 5
    return ChainJoints(
        np.ascontiguousarray(np.reshape([*weights, *levels], (-1, len(segments)))[:, free]),
        joint_table(segments[free], k),
        slots,
        np.tan(0.5 * np.array(limits))[free],
        np.flatnonzero(np.isin(np.flatnonzero(free), of_limbs)),
        np.flatnonzero(free[of_limbs]),
    )


def _weight(chain: Chain, part: BodyPart) -> float:
    """Weight of a part's joint in a chain. Limbs have none, because they are solved in closed form, except for a
    balance.
    """
    return chain.recruited(part) if part in (*UPPER_ARMS, *THIGHS) else chain.weight(part)


@cache
def segment_masses(layout: BodyLayout) -> FloatArray:
    """(S, 2) mass fraction of each segment, and position of its centre of mass along the segment (de Leva 1996, male;
    METHOD 11).
    """
    masses = np.zeros((layout.segment_count, 2))
    k = layout.spine_count
    masses[:k] = [0.3229 / (k - 1), 0.5]
    masses[0] = [0.1117, 0.5]
    masses[k], masses[k + 1] = (0.0, 0.5), (0.0694, 0.5)
    for side in range(2):
        arm, leg = k + 3 + 4 * side, k + 10 + 4 * side
        masses[arm : arm + 3] = [(0.0271, 0.577), (0.0162, 0.457), (0.0061, 0.5)]
        masses[leg : leg + 3] = [(0.1416, 0.41), (0.0433, 0.44), (0.0137, 0.4)]
    return masses


@cache
def point_masses(layout: BodyLayout) -> FloatArray:
    """Mass fractions (P,) of the body's points with the same centre of mass as ``segment_masses``."""
    points, (fractions, along) = np.zeros(layout.point_count), segment_masses(layout).T
    np.add.at(points, list(layout.proximal_points()), fractions * (1.0 - along))
    np.add.at(points, list(layout.distal_points()), fractions * along)
    return points
