"""Repair of rotations of joints whose scales mirror or flatten them in some frames."""

import numpy as np
from numpy.typing import NDArray

from studio.core.names import counted_noun

FloatArray = NDArray[np.float64]

FLAT_DETERMINANT = 1e-6
"""Determinant of a matrix of unit columns below which it counts as flattening or mirroring."""
_NAMED = 3


def proper_rotations(names: list[str], relative: FloatArray) -> tuple[FloatArray, tuple[str, ...]]:
    """Rotations (F, J, 3, 3) relative to the rest pose without mirroring, and a sentence about the repaired joints.

    A joint that is mirrored in the rest pose too needs no repair: relative to that pose it only rotates.
    """
    first, second, third = np.moveaxis(relative, -1, 0)
    # Not NumPy's determinant, which divides by zero where an axis is next to nothing.
    wrong = np.einsum("fji,fji->fj", first, np.cross(second, third)) < FLAT_DETERMINANT
    if not wrong.any():
        return relative, ()
    relative = np.where(wrong[..., None, None], np.eye(3), relative)
    joints = [name for name, is_wrong in zip(names, wrong.any(axis=0), strict=True) if is_wrong]
    shown = ", ".join(joints[:_NAMED]) + (f" and {len(joints) - _NAMED} more" if len(joints) > _NAMED else "")
    frames = int(wrong.any(axis=1).sum())
    return relative, (
        f"In {counted_noun(frames, 'frame')} scales mirror or flatten {shown}; there the joint is turned as at rest.",
    )
