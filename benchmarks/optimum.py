"""The nearest that two wrists can come to what they cannot reach: a numerical optimum, to judge the solver by.

The same freedoms as the solver has (turns of vertebrae and clavicles up to their limits, the root's travel), the same
held feet (no hip further from a planted ankle than its leg's comfort), balance kept exactly; of all such poses the one
with the least sum of squared misses, by nonlinear least squares (scipy) under rising penalties, from two beginnings.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from studio.core.kernels.joints import ROOT
from studio.core.solver.adapt import Standing
from studio.core.solver.chains import free_joints, segment_masses
from studio.core.solver.request import AdaptedMotion, AdaptRequest

FloatArray = NDArray[np.float64]

STEP = 1e-6
PENALTIES = 10.0, 100.0, 300.0
"""Metres of miss that one metre off balance or over a leash, or one radian over a limit, counts as; in turn."""
KEPT = 5e-4
"""Metres or radians by which a pose may overstep and still count."""


@dataclass(frozen=True, eq=False)
class Excess:
    """Metres by which wrists are further from their targets than they need be, (N,) frames: root mean squares."""

    misses: FloatArray
    least: FloatArray

    @property
    def values(self) -> FloatArray:
        return self.misses - self.least


def unreachable_excess(request: AdaptRequest, standing: Standing, adapted: AdaptedMotion, frames: list[int]) -> Excess:
    """How far the solver's answer to the worst task lies from the optimum, at some frames."""
    misses = [np.sqrt(np.mean(adapted.residuals[1:, frame] ** 2)) for frame in frames]
    least = [_Frame(request, standing, frame).least_miss() for frame in frames]
    return Excess(np.array(misses), np.array(least))


class _Frame:
    """One frame of a standing body whose trunk, clavicles and root may move."""

    def __init__(self, request: AdaptRequest, standing: Standing, frame: int) -> None:
        self.body, self.layout = standing.morphology, standing.morphology.layout
        self.points, wrists = standing.positions[frame], request.constraints[1:]
        joints = free_joints([wrist.chain for wrist in wrists], self.layout)
        trunk = {*range(self.layout.spine_count), self.layout.spine_count + 2, self.layout.spine_count + 6, ROOT}
        free = [(int(row[0]), limit) for row, limit in zip(joints.joints, joints.limits, strict=True) if row[0] in trunk]
        self.segments = [segment for segment, _ in free if segment != ROOT]
        self.limits = np.array([limit for segment, limit in free if segment != ROOT])
        self.targets = np.array([wrist.target for wrist in wrists])
        self.ankles = standing.footing.ankles[:, frame]
        planted = standing.footing.states[:, frame] != 0
        comforts = np.where(planted, standing.footing.comforts[:, frame], np.inf)
        self.leashes = comforts * self.body.leg.sum(axis=1)
        self.shares, self.along = segment_masses(self.layout).T
        self.centre = self._posed(np.zeros((1, 3 * len(self.segments) + 3)), straight=False)[1][0]

    def least_miss(self) -> float:
        """Root mean square of both misses at the best pose found."""
        lowered = np.zeros(3 * len(self.segments) + 3)
        lowered[-1] = -0.03  # straight knees have no slope
        forward = lowered.copy()
        forward[-3:-1] = 0.1 * (self.targets.mean(axis=0) - self.points[0])[:2]
        found = []
        for x in (lowered, forward):
            for penalty in PENALTIES:
                weights = np.concatenate([np.ones(6), np.full(4 + len(self.limits), penalty)])
                x = least_squares(
                    lambda y, w=weights: w * self._asked(y[None])[0],
                    x,
                    jac=lambda y, w=weights: w[:, None] * self._slopes(y),
                    max_nfev=200,
                ).x
            values = self._asked(x[None])[0]
            if np.abs(values[6:]).max() < KEPT:
                found.append(float(np.sqrt(np.sum(values[:6] ** 2) / 2.0)))
        return min(found, default=np.nan)

    def _slopes(self, x: FloatArray) -> FloatArray:
        """(values, variables) by central differences, all in one evaluation."""
        steps = STEP * np.eye(len(x))
        values = self._asked(np.concatenate([x + steps, x - steps]))
        return np.asarray((values[: len(x)] - values[len(x) :]).T / (2.0 * STEP))

    def _asked(self, x: FloatArray) -> FloatArray:
        """(B, values) what each wrist misses (2 x 3), balance off its place (2), leashes and limits overstepped."""
        shoulders, centres, hips = self._posed(x, straight=True)
        ways = self.targets - shoulders
        spans = np.linalg.norm(ways, axis=2)
        misses = ways * np.maximum(1.0 - self.body.arm.sum(axis=1) / spans, 0.0)[..., None]
        over = np.maximum(np.linalg.norm(self.ankles - hips, axis=2) - self.leashes, 0.0)
        turns = np.sqrt(np.sum(x[:, :-3].reshape(len(x), -1, 3) ** 2, axis=2) + 1e-18)
        beyond = np.maximum(turns - self.limits, 0.0)
        return np.concatenate([misses.reshape(len(x), 6), centres - self.centre, over, beyond], axis=1)

    def _posed(self, x: FloatArray, straight: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Shoulders (B, 2, 3), horizontal centres of mass (B, 2), hips (B, 2, 3); arms straight to their targets."""
        layout, old, count = self.layout, self.points, len(x)
        turns = np.tile(np.eye(3), (count, layout.segment_count, 1, 1))
        own = Rotation.from_rotvec(x[:, :-3].reshape(-1, 3)).as_matrix().reshape(count, -1, 3, 3)
        new = np.tile(old, (count, 1, 1))
        new[:, 0] = old[0] + x[:, -3:]
        parents = layout.parent_segments()
        near, far = layout.proximal_points(), layout.distal_points()
        carried = {layout.collar(0): layout.neck_base, layout.collar(1): layout.neck_base, layout.hip(0): 0, layout.hip(1): 0}
        for segment, parent in enumerate(parents):
            if parent >= 0:
                turns[:, segment] = turns[:, parent]
                origin = carried.get(near[segment])
                if origin is not None:
                    new[:, near[segment]] = new[:, origin] + turns[:, parent] @ (old[near[segment]] - old[origin])
            if segment in self.segments:
                turns[:, segment] = turns[:, segment] @ own[:, self.segments.index(segment)]
            new[:, far[segment]] = new[:, near[segment]] + turns[:, segment] @ (old[far[segment]] - old[near[segment]])
        for side in range(2):
            if straight:
                self._stretch_arm(side, new)
            self._place_leg(side, new)
        begin, end = new[:, list(near)], new[:, list(far)]
        centres = np.einsum("s,bsi->bi", self.shares, begin + self.along[:, None] * (end - begin))
        return new[:, [layout.collar(k) + 1 for k in (0, 1)]], centres[:, :2], new[:, [layout.hip(k) for k in (0, 1)]]

    def _stretch_arm(self, side: int, points: FloatArray) -> None:
        shoulder = self.layout.collar(side) + 1
        way = self.targets[side] - points[:, shoulder]
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        hand = np.linalg.norm(self.body.hand[side])
        for bone, length in enumerate((*self.body.arm[side], hand)):
            points[:, shoulder + bone + 1] = points[:, shoulder + bone] + length * way

    def _place_leg(self, side: int, points: FloatArray) -> None:
        """Ankle where it was; the knee bends to where it did, carried along by the shortest turn of the leg."""
        hip = self.layout.hip(side)
        upper, lower = self.body.leg[side]
        ankle, before = self.points[hip + 2], self.points[hip + 2] - self.points[hip]
        before = before / np.linalg.norm(before)
        bend = self.points[hip + 1] - self.points[hip]
        bend = bend - bend @ before * before
        bend /= max(float(np.linalg.norm(bend)), 1e-9)
        way = ankle - points[:, hip]
        span = np.linalg.norm(way, axis=1, keepdims=True)
        way /= span
        axis, cosine = np.cross(before, way), way @ before
        bend = bend + np.cross(axis, bend) + np.cross(axis, np.cross(axis, bend)) / (1.0 + cosine[:, None])
        along = (upper**2 - lower**2 + span**2) / (2.0 * span)
        points[:, hip + 1] = points[:, hip] + along * way + np.sqrt(np.maximum(upper**2 - along**2, 0.0) + 1e-5) * bend
        points[:, hip + 2 : hip + 5] = self.points[hip + 2 : hip + 5]
