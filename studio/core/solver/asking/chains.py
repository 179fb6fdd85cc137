"""The joints that a constraint's chain may move: their mobilities and limits for ``kernels.search``."""

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

ROOT_MOBILITY = 0.15
"""Mobility of the root's translation beside one vertebra's rotation (square metres)."""
MOBILITIES = {**dict.fromkeys(CLAVICLES, 4.0), **dict.fromkeys(UPPER_ARMS, 30.0), **dict.fromkeys(THIGHS, 5.0)}
"""Mobilities of other joints than vertebrae (METHOD 6). Shoulders and hips are those of free arms and legs, which a
balance recruits: what each then does is in proportion to its mass.
"""
VERTEBRA_LIMIT, CLAVICLE_LIMIT, NECK_LIMIT = 0.5, 0.35, 0.7
SHOULDER_LIMIT, HIP_LIMIT = 0.7, 0.4
"""Radians that a joint may turn away from the motion, in all."""


@dataclass(frozen=True, eq=False)
class FreeJoints:
    """The joints that any of some chains frees, as ``kernels.search.joints`` takes them: ``mobilities`` (C + L, N)
    what each chain makes of them and each level any down to it, ``joints`` (N,), ``slots`` (S + 1,), ``limits`` (N,)
    the tan of half the angle that each may turn in all. ``recruited`` (n,) of them are shoulders and hips, of
    ``limbs`` (n,).
    """

    weights: FloatArray
    joints: NDArray[np.void]
    joint_of_segment: NDArray[np.int64]
    limits: FloatArray
    recruited: NDArray[np.int64]
    limbs: NDArray[np.int64]

    @cached_property
    def nominal_weights(self) -> FloatArray:
        """(C + L + 1, n) mobilities and, last, limits of those that are recruited, however free they are."""
        return np.ascontiguousarray(np.vstack([self.weights, np.nan_to_num(self.limits)])[:, self.recruited])

    @property
    def chain(self) -> records.JointWeights:
        """Kernels write in mobilities and limits how free limbs are at a frame: these are the caller's own."""
        return records.JointWeights(self.weights.copy(), self.joints, self.joint_of_segment, self.limits.copy())

    @property
    def without_limits(self) -> "FreeJoints":
        return replace(self, limits=np.full_like(self.limits, np.inf))


def carrying_chain(constraint: Constraint) -> Chain:
    """The chain of a constraint without what is of no use to it: of the place of a limb the clavicles of others, which
    neither carry it nor balance it as neck and head do.
    """
    alone = isinstance(constraint, PositionConstraint) and not isinstance(constraint.target, FollowBody)
    limb = limb_of(constraint.point.part)
    return _without_clavicles(constraint.chain, limb) if alone and limb >= 0 else constraint.chain


@lru_cache(maxsize=256)
def _without_clavicles(chain: Chain, limb: int) -> Chain:
    named = {part for part, _ in chain.segments}
    idle = [clavicle for side, clavicle in enumerate(CLAVICLES) if side != limb and clavicle not in named]
    return replace(chain, segments=(*chain.segments, *((clavicle, 0.0) for clavicle in idle)))


@lru_cache(maxsize=256)
def free_joints(chains: tuple[Chain, ...], ranks: tuple[int, ...], layout: BodyLayout) -> FreeJoints:
    """Pelvis, spine, clavicles, neck, head, free limbs and the root's translation, as far as ``chains`` free them.

    ``ranks`` (C,) is the level of each chain's constraint.
    """
    k = layout.spine_count
    segments = np.array([*range(k), k + 2, k + 6, k, k + 1, k + 3, k + 7, k + 10, k + 14, ROOT_TRANSLATION])
    trunk = [*[VERTEBRA_LIMIT] * k, *[CLAVICLE_LIMIT] * 2, *[NECK_LIMIT] * 2]
    limits = [*trunk, *[SHOULDER_LIMIT] * 2, *[HIP_LIMIT] * 2, np.pi / 2]
    parts = [layout.part(segment) for segment in segments[:-1]]
    usual = np.array([*(MOBILITIES.get(part, 1.0) for part in parts), ROOT_MOBILITY])
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
    return FreeJoints(
        np.ascontiguousarray(np.reshape([*weights, *levels], (-1, len(segments)))[:, free]),
        joint_table(segments[free], k),
        slots,
        np.tan(0.5 * np.array(limits))[free],
        np.flatnonzero(np.isin(np.flatnonzero(free), of_limbs)),
        np.flatnonzero(free[of_limbs]),
    )


def _weight(chain: Chain, part: BodyPart) -> float:
    """How freely a chain lets a joint turn a segment; limbs are bent in closed form, but for those of a balance."""
    return chain.recruited(part) if part in (*UPPER_ARMS, *THIGHS) else chain.weight(part)


@cache
def segment_masses(layout: BodyLayout) -> FloatArray:
    """(S, 2) share of the body's mass and its place along each segment (de Leva 1996, male; METHOD 7)."""
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
    """(P,) shares of the body's mass that its points would have to have for the centre of mass to be the same."""
    points, (shares, along) = np.zeros(layout.point_count), segment_masses(layout).T
    np.add.at(points, list(layout.proximal_points()), shares * (1.0 - along))
    np.add.at(points, list(layout.distal_points()), shares * along)
    return points
