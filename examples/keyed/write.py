"""Solved clips as small BVH files."""

import re
from pathlib import Path

from studio.io.bvh_writer import write_bvh

from .performer import make_skeleton
from .solve import solve
from .targets import FRAME_RATE, Targets

_DECIMALS = 4
"""Ten-thousandths of a degree and micrometres: every joint within 0.01 mm at half the size."""


def write_capture(path: Path, targets: Targets) -> int:
    """Solve ``targets`` and write them as BVH; returns how many frames."""
    poses = solve(targets)
    write_bvh(path, make_skeleton(), poses, FRAME_RATE)
    header, motion = path.read_text(encoding="utf-8").split("MOTION\n")
    *head, rows = motion.split("\n", 2)
    rounded = re.sub(r"[-+.\de]+", lambda word: f"{round(float(word[0]), _DECIMALS):.7g}", rows)
    path.write_text("\n".join([f"{header}MOTION", *head, rounded]), encoding="utf-8")
    return poses.frame_count
