"""Blender as a second reader of what the studio writes: its Python package ``bpy``, in an environment of its own.

The variable MORPHO_BLENDER names a Python that has it (``python -m venv DIR && DIR/bin/pip install bpy``).
"""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

VARIABLE = "MORPHO_BLENDER"
SCRIPT = Path(__file__).with_name("in_blender.py")


def opened_in_blender(path: Path, *, frames: int, rate: float, action_of: Path | None = None) -> dict[str, Any]:
    """A file as Blender reads it, in metres and world axes: by armature, by mesh and by other object.

    ``bones`` names, ``heads`` (F, B, 3), ``rotations`` (F, B, 3, 3) since they were bound; ``vertices`` (F, V, 3);
    ``places`` (F, 3). ``cameras`` have their vertical ``angle`` of view and ``axes``: right, up, backward. With
    ``action_of``, the armature moves as that of another file. Skips where there is no Blender.
    """
    python = os.environ.get(VARIABLE)
    if not python:
        pytest.skip(f"{VARIABLE} names no Python with Blender's package bpy")
    target = path.with_suffix(".blender.npz")
    command = [python, str(SCRIPT), str(path), str(target), str(frames), str(rate), str(action_of or "")]
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    with np.load(target) as read:
        found: dict[str, Any] = json.loads(str(read["about"]))
        for kind in ("armatures", "meshes", "objects"):
            for name, record in found[kind].items():
                record |= {key: read[f"{kind} {name} {key}"] for key in record.pop("arrays")}
    return found
