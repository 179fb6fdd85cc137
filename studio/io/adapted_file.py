"""Adapted motions in a small file, shown before anything can be solved: the sample with which the studio opens.

Positions are stored to a tenth of a millimetre and rotations to a ten-thousandth of a radian, as differences from frame
to frame.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.rotations import from_matrix, normalized, sign_continuous, to_matrix
from studio.core.solver.request import AdaptedMotion, UnconstrainedPoses

POSITION_STEPS_PER_METRE, QUATERNION_STEPS = 1e4, 32767.0
"""Number of quantisation steps in a metre, and in the unit of a quaternion's component."""


def write_adapted(path: Path, motions: Mapping[str, AdaptedMotion]) -> None:
    """Write adapted motions without their constraints, by name."""
    arrays: dict[str, NDArray[np.int16]] = {}
    for name, motion in motions.items():
        arrays[f"{name}.places"] = _differences(POSITION_STEPS_PER_METRE * motion.positions[:])
        arrays[f"{name}.turns"] = _differences(QUATERNION_STEPS * sign_continuous(from_matrix(motion.rotations[:])))
    np.savez_compressed(path, allow_pickle=False, **arrays)


def read_adapted(path: Path, bodies: Mapping[str, Morphology], frame_rate: float) -> dict[str, AdaptedMotion]:
    """Adapted motions in the file, by name, for ``bodies`` of the same names."""
    with np.load(path, allow_pickle=False) as arrays:
        kept = {
            name: (arrays[f"{name}.places"], arrays[f"{name}.turns"]) for name in bodies if f"{name}.places" in arrays
        }
    return {
        name: _motion(
            bodies[name],
            frame_rate,
            np.cumsum(places, axis=0, dtype=np.int64) / POSITION_STEPS_PER_METRE,
            to_matrix(normalized(np.cumsum(turns, axis=0, dtype=np.int64) / QUATERNION_STEPS)),
        )
        for name, (places, turns) in kept.items()
    }


def _motion(
    body: Morphology, frame_rate: float, positions: NDArray[np.float64], rotations: NDArray[np.float64]
) -> AdaptedMotion:
    """Adapted motion without constraints, which is also its own grounded motion."""
    nothing = np.empty((0, len(positions)))
    return AdaptedMotion(
        body, frame_rate, 0, positions, rotations, nothing, unconstrained=UnconstrainedPoses(positions, rotations)
    )


def _differences(values: NDArray[np.float64]) -> NDArray[np.int16]:
    return np.diff(np.round(values), axis=0, prepend=0.0).astype(np.int16)
