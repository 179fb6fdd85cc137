"""The nearest that wrists can come to what they cannot reach: a numerical optimum, to judge the solver by.

The same freedoms as the solver has (turns of vertebrae and clavicles up to their limits, the root's travel), the same
held feet (no hip further from a planted ankle than its leg's comfort), balance kept exactly; of all such poses the one
with the least sum of squared misses, by nonlinear least squares (scipy) under rising penalties, from two beginnings.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from studio.cli.bench_cases import BenchCase, target_positions
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import Constraint
from studio.core.constraints.position import PositionConstraint
from studio.core.kernels.search.joints import ROOT_TRANSLATION
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.task_assembly.chains import joints_of_chains, relevant_chain, segment_masses

FloatArray = NDArray[np.float64]

STEP = 1e-6
PENALTIES = 10.0, 100.0, 300.0
"""Metres of miss that one metre off balance or beyond its reach, or one radian over a limit, counts as; in turn."""
KEPT = 5e-4
"""Metres or radians by which a pose may overstep and still count."""


def excess(
    task: BenchCase,
    constraints: Sequence[Constraint],
    standing: GroundedMotion,
    residuals: FloatArray,
    frames: Sequence[int],
) -> FloatArray:
    """(N,) metres by which wrists miss their targets more than they need, at some frames: root mean squares.

    ``constraints`` of the task are positions of wrists, all of one priority, and perhaps a balance above them;
    ``residuals`` (C, F) what the solver left of them.
    """
    wrists = [row for row, each in enumerate(constraints) if isinstance(each, PositionConstraint)]
    misses = [np.sqrt(np.mean(residuals[wrists, frame] ** 2)) for frame in frames]
    least = [_Frame(task, constraints, standing, frame).least_miss() for frame in frames]
    return np.array(misses) - np.array(least)


class _Frame:
    """One frame of a standing body whose trunk, clavicles and root may move as far as the constraints' chains allow."""

    def __init__(
        self, task: BenchCase, constraints: Sequence[Constraint], standing: GroundedMotion, frame: int
    ) -> None:
        self.body, self.layout = standing.morphology, standing.morphology.layout
        self.points = standing.positions[frame]
        wrists = [each for each in constraints if isinstance(each, PositionConstraint)]
        ranks = np.zeros(len(constraints), dtype=np.int64)
        joints = joints_of_chains(tuple(map(relevant_chain, constraints)), tuple(ranks.tolist()), self.layout)
        trunk = {*range(self.layout.spine_count), self.layout.spine_count + 2, self.layout.spine_count + 6}
        free = dict(zip(joints.joints["segment"].tolist(), 2.0 * np.arctan(joints.limits), strict=True))
        self.segments = sorted(trunk & free.keys())
        self.limits = np.array([free[segment] for segment in self.segments])
        self.root_is_free = ROOT_TRANSLATION in free
        self.sides = [int(each.point.part.startswith("right")) for each in wrists]
        self.targets = np.array([target_positions(task, each)[frame] for each in wrists])
        self.reaches = self.body.arm.sum(axis=1)[self.sides]
        self.ankles = standing.footing.ankles[:, frame]
        planted = standing.footing.states[:, frame] != 0
        comforts = np.where(planted, standing.footing.soft_thresholds[:, frame], np.inf)
        self.root_reaches = comforts * self.body.leg.sum(axis=1)
        self.balances = any(isinstance(each, BalanceConstraint) for each in constraints)
        self.shares, self.along = segment_masses(self.layout).T
        self.size = 3 * len(self.segments) + 3 * self.root_is_free
        self.centre = self._posed(np.zeros((1, self.size)), reaching=False)[1][0]

    def least_miss(self) -> float:
        """Root mean square of the misses at the best pose found."""
        first = np.zeros(self.size)
        starts = [first]
        if self.root_is_free:
            first[-1] = -0.03  # straight knees have no slope
            starts.append(first.copy())
            starts[1][-3:-1] = 0.1 * (self.targets.mean(axis=0) - self.points[0])[:2]
        found = []
        for x in starts:
            for penalty in PENALTIES if self.size else ():
                x = self._improved(x, penalty)
            values = self._asked(x[None])[0]
            misses = values[: self.targets.size]
            if np.abs(values[self.targets.size :]).max() < KEPT:
                found.append(float(np.sqrt(np.sum(misses**2) / len(self.targets))))
        return min(found, default=np.nan)

    def _improved(self, x: FloatArray, penalty: float) -> FloatArray:
        count = self.targets.size
        weights = np.concatenate([np.ones(count), np.full(4 + len(self.limits), penalty)])
        return np.asarray(
            least_squares(
                lambda y: weights * self._asked(y[None])[0],
                x,
                jac=lambda y: weights[:, None] * self._slopes(y),
                max_nfev=200,
            ).x
        )

    def _slopes(self, x: FloatArray) -> FloatArray:
        """(values, variables) by central differences, all in one evaluation."""
        steps = STEP * np.eye(len(x))
        values = self._asked(np.concatenate([x + steps, x - steps]))
        return np.asarray((values[: len(x)] - values[len(x) :]).T / (2.0 * STEP))

    def _asked(self, x: FloatArray) -> FloatArray:
        """(B, values) what each wrist misses (2 x 3), balance off its place (2), root too far, limits overstepped."""
        shoulders, centres, hips = self._posed(x, reaching=True)
        ways = self.targets - shoulders
        spans = np.linalg.norm(ways, axis=2)
        misses = ways * np.maximum(1.0 - self.reaches / spans, 0.0)[..., None]
        moved = centres - self.centre if self.balances else np.zeros((len(x), 2))
        over = np.maximum(np.linalg.norm(self.ankles - hips, axis=2) - self.root_reaches, 0.0)
        beyond = np.maximum(np.sqrt(np.sum(self._turns(x) ** 2, axis=2) + 1e-18) - self.limits, 0.0)
        return np.concatenate([misses.reshape(len(x), -1), moved, over, beyond], axis=1)

    def _turns(self, x: FloatArray) -> FloatArray:
        """(B, J, 3) rotation vectors of the free joints."""
        count = len(self.segments)
        return x[:, : 3 * count].reshape(len(x), count, 3)

    def _posed(self, x: FloatArray, reaching: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Shoulders (B, wrists, 3), horizontal centres of mass (B, 2), hips (B, 2, 3); arms reach for their targets."""
        layout, old, count = self.layout, self.points, len(x)
        turns = np.tile(np.eye(3), (count, layout.segment_count, 1, 1))
        vectors = self._turns(x)
        own = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix().reshape(*vectors.shape, 3)
        new = np.tile(old, (count, 1, 1))
        new[:, 0] = old[0] + (x[:, -3:] if self.root_is_free else 0.0)
        parents = layout.parent_segments()
        near, far = layout.proximal_points(), layout.distal_points()
        carried = {
            layout.collar_point(0): layout.neck_base,
            layout.collar_point(1): layout.neck_base,
            layout.hip_point(0): 0,
            layout.hip_point(1): 0,
        }
        for segment, parent in enumerate(parents):
            if parent >= 0:
                turns[:, segment] = turns[:, parent]
                origin = carried.get(near[segment])
                if origin is not None:
                    new[:, near[segment]] = new[:, origin] + turns[:, parent] @ (old[near[segment]] - old[origin])
            if segment in self.segments:
                turns[:, segment] = turns[:, segment] @ own[:, self.segments.index(segment)]
            new[:, far[segment]] = new[:, near[segment]] + turns[:, segment] @ (old[far[segment]] - old[near[segment]])
        for wrist, side in enumerate(self.sides if reaching else ()):
            self._stretch_arm(side, self.targets[wrist], new)
        for side in range(2):
            self._place_leg(side, new)
        begin, end = new[:, list(near)], new[:, list(far)]
        centres = np.einsum("s,bsi->bi", self.shares, begin + self.along[:, None] * (end - begin))
        return (
            new[:, [layout.collar_point(side) + 1 for side in self.sides]],
            centres[:, :2],
            new[:, [layout.hip_point(k) for k in (0, 1)]],
        )

    def _stretch_arm(self, side: int, target: FloatArray, points: FloatArray) -> None:
        """Straight towards its target, no further than that: a bent arm's mass lies about there, too."""
        shoulder = self.layout.collar_point(side) + 1
        way = target - points[:, shoulder]
        span = np.linalg.norm(way, axis=1, keepdims=True)
        share = np.minimum(span / self.body.arm[side].sum(), 1.0)
        hand = np.linalg.norm(self.body.hand[side])
        for bone, length in enumerate((*self.body.arm[side], hand)):
            points[:, shoulder + bone + 1] = points[:, shoulder + bone] + share * length * way / span

    def _place_leg(self, side: int, points: FloatArray) -> None:
        """Ankle where it was; the knee bends to where it did, carried along by the shortest turn of the leg."""
        hip = self.layout.hip_point(side)
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
