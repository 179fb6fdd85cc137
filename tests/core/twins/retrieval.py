"""Every frame tried, and the distance of two poses by its definition."""

import numpy as np
from scipy.optimize import minimize_scalar

from studio.core.clip_search import PoseQuery, SearchMatch, SearchTable, pose_distances
from studio.core.kernels import pose_search as at


def brute_force(table: SearchTable, query: PoseQuery, count: int, allowed: np.ndarray) -> list[SearchMatch]:
    best = []
    for clip, (actor, limb, begin, length) in enumerate(table.clips):
        if not allowed[clip]:
            continue
        rows = table.rows[table.first_rows[clip] :][: table.frame_counts[clip]]
        posture, turns = pose_distances(query.poses[actor], rows)
        offsets = (
            table.paths[begin : begin + length]
            - np.pad(rows[:, at.POSE_CENTRE : at.POSE_CENTRE + 2], ((0, 0), (0, 1)))[:, None]
        )
        c, s = np.cos(turns)[:, None], np.sin(turns)[:, None]
        x, y = c * offsets[..., 0] - s * offsets[..., 1], s * offsets[..., 0] + c * offsets[..., 1]
        away = np.linalg.norm(np.stack([x, y, offsets[..., 2]], axis=2) - query.targets[actor, limb], axis=2)
        reach = away.min(axis=1)
        cost = query.posture_weight * posture + query.reach_weight * reach
        frame = int(np.argmin(cost))
        numbers = (float(each[frame]) for each in (cost, posture, reach, turns))
        best.append(SearchMatch(clip, frame, int(away[frame].argmin()), *numbers))
    return sorted(best, key=lambda each: each.cost)[:count]


def kovar_distance(one: np.ndarray, other: np.ndarray) -> float:
    """Least root mean square distance of points over turns about Z; the best shift joins the middles."""
    a, b = (points - [*points[:, :2].mean(axis=0), 0.0] for points in (one, other))

    def apart(angle: float) -> float:
        c, s = np.cos(angle), np.sin(angle)
        return float(np.square(a - b @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])).sum(axis=1).mean())

    starts = np.linspace(-np.pi, np.pi, 13)
    return float(np.sqrt(min(minimize_scalar(apart, bounds=(x - 0.5, x + 0.5), method="bounded").fun for x in starts)))
