"""Other solvers on the same tasks, each a script in an interpreter that has its library; the studio needs none."""

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.clips import ROOT
from studio.cli.bench_cases import BenchCase, target_positions
from studio.core.body.morphology import Morphology
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.quality.metrics import centre_of_mass
from studio.core.rigs.character_skeleton import character_poses, character_skeleton, joint_points
from studio.core.solver.adapt import adapt, solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.task_assembly.chains import segment_masses
from studio.core.solver.task_assembly.points import point_indices

PYTHON = os.environ.get("PEERS_PYTHON", sys.executable)
"""The interpreter in which the peers are installed, as by ``pip install -e .[peers]``."""
FRAMES = 40
"""Frames of a clip that each peer solves."""


@dataclass(frozen=True)
class Peer:
    """A script beside this file, the module that it needs, and what it is."""

    script: str
    module: str
    name: str
    note: str


PEERS = (
    Peer("pinocchio_clik.py", "pinocchio", "Pinocchio", "closed-loop inverse kinematics by hand, damped, weighted"),
    Peer("mink_qp.py", "mink", "mink", "quadratic programmes over MuJoCo, daqp, weighted"),
    Peer(
        "blender_ik.py", "bpy", "Blender", "its IK constraints; pelvis and feet fixed, neither balance nor priorities"
    ),
)


def run_peers(tasks: Sequence[BenchCase]) -> dict[str, dict[str, Any] | None]:
    """For each peer its answers by task; None for one that is not installed.

    An answer: ``microseconds`` a frame (processor time, the median of three runs), ``median`` and ``worst`` of the
    highest wish's miss, of the feet's slide and of the balance, in millimetres.
    """
    with tempfile.TemporaryDirectory(prefix="morpho-studio-peers-") as folder:
        files = []
        for number, task in enumerate(tasks):
            files.append(str(Path(folder) / f"{number}.npz"))
            np.savez(files[-1], **problem(task))
        return {peer.name: _answers(peer, tasks, files) if _installed(peer) else None for peer in PEERS}


def our_answer(task: BenchCase, microseconds: float) -> dict[str, Any]:
    """The studio's answers, judged as the peers' are: every frame of the clip."""
    request = task.request
    adapted = adapt(request)
    before = solve_constraints(ground_motion(request.motion, request.morphology, request.contacts, request.ground), ())
    ankles = [request.morphology.layout.ankle_point(side) for side in range(2)]
    figures = {
        "miss": adapted.residuals[request.constraints.index(task.highest)],
        "slide": np.linalg.norm(adapted.positions[:, ankles] - before.positions[:, ankles], axis=2).max(axis=1),
        "balance": np.linalg.norm((centre_of_mass(adapted) - centre_of_mass(before))[:, :2], axis=1),
    }
    return {"microseconds": microseconds} | {
        name: [1e3 * float(np.median(values)), 1e3 * float(values.max())] for name, values in figures.items()
    }


def problem(task: BenchCase) -> dict[str, Any]:
    """One task on an ordinary skeleton, in arrays: what the scripts read (``common.Problem``)."""
    request = task.request
    body: Morphology = request.morphology
    standing = ground_motion(request.motion, body, request.contacts, request.ground)
    skeleton, poses = character_skeleton(body), character_poses(solve_constraints(standing, ()))
    frames = np.linspace(0, request.motion.frame_count - 1, FRAMES).astype(int)
    places = [each for each in request.constraints if isinstance(each, PositionConstraint)]
    points = list(joint_points(body.layout))
    free = np.zeros(skeleton.joint_count, dtype=bool)
    for place in places:
        side = place.point.part.value.split("_")[0].capitalize()
        parts = {f"{side}Arm": place.chain.limb, f"{side}ForeArm": place.chain.limb}
        parts[f"{side}Shoulder"] = place.chain.clavicle
        free |= np.array([parts.get(name, 0.0) > 0.0 for name in skeleton.names])
        free |= np.array([name.startswith("Spine") and place.chain.trunk > 0.0 for name in skeleton.names])
    shares, along = segment_masses(body.layout).T
    ends = list(body.layout.distal_points())
    starts = list(body.layout.proximal_points())
    return {
        "names": np.array(skeleton.names),
        "parents": skeleton.parents,
        "offsets": skeleton.offsets,
        "rotations": poses.local_rotations[frames],
        "roots": poses.local_translations[frames, 0],
        "wishes": np.array([points.index(point_indices(place.point, body.layout)[0]) for place in places]),
        "targets": np.array([target_positions(task, place)[frames] for place in places]),
        "priorities": np.array([place.priority for place in places]),
        "free": free,
        "holds_feet": bool(request.contacts),
        "balances": any(isinstance(each, BalanceConstraint) for each in request.constraints),
        "mass_joints": np.array(
            [[points.index(start), points.index(end)] for start, end in zip(starts, ends, strict=True)]
        ),
        "mass_shares": shares,
        "mass_places": along,
    }


def _installed(peer: Peer) -> bool:
    if sys.executable == PYTHON:
        return importlib.util.find_spec(peer.module) is not None
    seek = f"import importlib.util, sys; sys.exit(importlib.util.find_spec({peer.module!r}) is None)"
    return subprocess.run([PYTHON, "-c", seek], check=False).returncode == 0


def _answers(peer: Peer, tasks: Sequence[BenchCase], files: Sequence[str]) -> dict[str, Any]:
    script = str(ROOT / "benchmarks" / "peers" / peer.script)
    done = subprocess.run([PYTHON, script, *files], check=True, stdout=subprocess.PIPE, text=True)
    answers = json.loads(done.stdout.splitlines()[-1])
    return dict(zip([task.name for task in tasks], answers, strict=True))
