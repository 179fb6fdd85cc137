"""Shared parts of the peers' scripts: the problem, timing and judging of an answer. Needs numpy alone."""

import json
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

RUNS = 3
FEET = "LeftFoot", "RightFoot"


class Problem:
    """One task on a skeleton of J joints, for N frames; arrays as ``benchmarks.peers.problem`` writes them."""

    def __init__(self, path: str) -> None:
        with np.load(path) as arrays:
            self.names = [str(name) for name in arrays["names"]]
            self.parents, self.offsets = arrays["parents"].tolist(), arrays["offsets"]
            self.rotations, self.roots = arrays["rotations"], arrays["roots"]
            self.wishes, self.targets, self.priorities = (
                arrays["wishes"].tolist(),
                arrays["targets"],
                arrays["priorities"],
            )
            self.free, self.mass_joints = arrays["free"], arrays["mass_joints"]
            self.mass_shares, self.mass_places = arrays["mass_shares"], arrays["mass_places"]
            self.holds_feet, self.balances = bool(arrays["holds_feet"]), bool(arrays["balances"])
        self.feet = [self.names.index(name) for name in FEET]
        if self.holds_feet:
            self.free |= np.array([name.endswith(("UpLeg", "Leg", "Foot")) for name in self.names])

    @property
    def root_is_free(self) -> bool:
        return self.balances

    def forward(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Places (J, 3) and rotations (J, 3, 3) of the joints before anything is solved."""
        places, turns = np.empty((len(self.names), 3)), np.empty((len(self.names), 3, 3))
        for joint, parent in enumerate(self.parents):
            local = matrix(self.rotations[frame, joint])
            if parent < 0:
                places[joint], turns[joint] = self.roots[frame], local
            else:
                places[joint] = places[parent] + turns[parent] @ self.offsets[joint]
                turns[joint] = turns[parent] @ local
        return places, turns

    def centre(self, places: np.ndarray) -> np.ndarray:
        """(3,) centre of mass."""
        begin, end = places[self.mass_joints[:, 0]], places[self.mass_joints[:, 1]]
        return np.asarray(self.mass_shares @ (begin + self.mass_places[:, None] * (end - begin)))


class Solver(Protocol):
    """A peer: made once for a problem, then asked for one frame after the other, each from its own pose."""

    def solve(self, frame: int) -> object:
        """Solve one frame; what is timed."""

    def places(self) -> np.ndarray:
        """(J, 3) where the joints are after the last solve."""


def matrix(quaternion: np.ndarray) -> np.ndarray:
    """(3, 3) of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def main(make: Callable[[Problem], Solver]) -> None:
    """Answer the problems named on the command line; one line of JSON at the end."""
    print(json.dumps([answer(Problem(path), make) for path in sys.argv[1:]]))


def answer(problem: Problem, make: Callable[[Problem], Solver]) -> dict[str, Any]:
    """Time and judge one solver on one problem."""
    solver, frames = make(problem), range(len(problem.rotations))
    misses, slides, balances = [], [], []
    first = int(np.argmin(problem.priorities))
    for frame in frames:
        before = problem.forward(frame)[0]
        solver.solve(frame)
        after = solver.places()
        misses.append(np.linalg.norm(after[problem.wishes[first]] - problem.targets[first, frame]))
        slides.append(np.linalg.norm(after[problem.feet] - before[problem.feet], axis=1).max())
        balances.append(np.linalg.norm((problem.centre(after) - problem.centre(before))[:2]))
    times = []
    for _ in range(RUNS):
        start = time.process_time()
        for frame in frames:
            solver.solve(frame)
        times.append((time.process_time() - start) / len(frames))
    figures = {"miss": misses, "slide": slides, "balance": balances}
    return {"microseconds": 1e6 * statistics.median(times)} | {
        name: [1e3 * float(np.median(values)), 1e3 * float(np.max(values))] for name, values in figures.items()
    }
