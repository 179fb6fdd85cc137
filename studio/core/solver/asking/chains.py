"""Joints of a constraint's chain: their weights and limits for ``kernels.search``."""

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
from studio.core.solver.asking.points import limb_of

FloatArray = NDArray[np.float64]

ROOT_WEIGHT = 0.15
"""Weight of the root's translation relative to one vertebra's rotation (square metres)."""
JOINT_WEIGHTS = {**dict.fromkeys(CLAVICLES, 4.0), **dict.fromkeys(UPPER_ARMS, 30.0), **dict.fromkeys(THIGHS, 5.0)}
"""Weights of other joints than vertebrae (METHOD 9). Those of shoulders and hips are for the redundant arms and legs of
a balance, in proportion to their masses.
"""
VERTEBRA_LIMIT, CLAVICLE_LIMIT, NECK_LIMIT = 0.5, 0.35, 0.7
SHOULDER_LIMIT, HIP_LIMIT = 0.7, 0.4
"""Greatest rotation of a joint away from the motion, in radians."""


@dataclass(frozen=True, eq=False)
class ChainJoints:
    """Joints with a weight in at least one chain, the input of ``kernels.search.joints``: N joints, C chains, L levels,
    S segments.

    ``weights`` (C + L, N) of each chain, then of each level with all above it; ``joints`` (N,); ``joint_of_segment`` (S
    + 1,); ``limits`` (N,) the tangent of half the greatest angle. ``recruited`` (n,) are the indices of shoulders and
    hips among them, of the ``limbs`` (n,).
    """

    weights: FloatArray
    joints: NDArray[np.void]
    joint_of_segment: NDArray[np.int64]
    limits: FloatArray
    recruited: NDArray[np.int64]
    limbs: NDArray[np.int64]

    @cached_property
    def nominal_weights(self) -> FloatArray:
        """Weights (C + L + 1, n) and, last, limits of the redundant joints at full availability."""
        return np.ascontiguousarray(np.vstack([self.weights, np.nan_to_num(self.limits)])[:, self.recruited])

    @property
    def kernel_weights(self) -> records.JointWeights:
        """Copy for the kernels, which write the availability of limbs at a frame into weights and limits."""
        return records.JointWeights(self.weights.copy(), self.joints, self.joint_of_segment, self.limits.copy())

    @property
    def without_limits(self) -> "ChainJoints":
        return replace(self, limits=np.full_like(self.limits, np.inf))


def relevant_chain(constraint: Constraint) -> Chain:
    """Chain of a constraint without useless joints: for a position on a limb, without the clavicles of other limbs."""
    alone = isinstance(constraint, PositionConstraint) and not isinstance(constraint.target, FollowBody)
    limb = limb_of(constraint.point.part)
    return _without_clavicles(constraint.chain, limb) if alone and limb >= 0 else constraint.chain


@lru_cache(maxsize=256)
def _without_clavicles(chain: Chain, limb: int) -> Chain:
    named = {part for part, _ in chain.segments}
    idle = [clavicle for side, clavicle in enumerate(CLAVICLES) if side != limb and clavicle not in named]
    return replace(chain, segments=(*chain.segments, *((clavicle, 0.0) for clavicle in idle)))


@lru_cache(maxsize=256)
def joints_of_chains(chains: tuple[Chain, ...], ranks: tuple[int, ...], layout: BodyLayout) -> ChainJoints:
    """Joints of pelvis, spine, clavicles, neck, head, redundant limbs and root translation that ``chains`` free.

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
    """Weight of a joint in a chain; limbs are solved in closed form, except the redundant limbs of a balance."""
    return chain.recruited(part) if part in (*UPPER_ARMS, *THIGHS) else chain.weight(part)


@cache
def segment_masses(layout: BodyLayout) -> FloatArray:
    """Mass fraction and position of the centre of mass along each segment, (S, 2) (de Leva 1996, male; METHOD 11)."""
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
    """Mass fractions (P,) of points that give the same centre of mass."""
    points, (fractions, along) = np.zeros(layout.point_count), segment_masses(layout).T
    np.add.at(points, list(layout.proximal_points()), fractions * (1.0 - along))
    np.add.at(points, list(layout.distal_points()), fractions * along)
    return points
