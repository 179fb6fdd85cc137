"""PoseSequence: local rotations and translations of every joint of a skeleton, frame by frame."""

from collections.abc import Iterator
from dataclasses import InitVar, dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.frozen_array import frozen_array

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class PoseSequence:
    """Local rotations and translations of J joints over F frames (at least one).

    Quaternions are normalised and made continuous in sign; with ``own`` this happens in place, in the caller's array.
    Read-only translations are not copied. Raises StudioError if shapes disagree, a number is not finite or a quaternion
    has no length.
    """

    local_rotations: FloatArray
    """Unit quaternions (F, J, 4) xyzw, from joint axes to the parent's."""
    local_translations: FloatArray
    """Translations (F, J, 3) in metres, in the parent's axes: the travel of the root, and the bones of the other
    joints.
    """

    own: InitVar[bool] = False

    def __post_init__(self, own: bool) -> None:
        from studio.core.kernels.body.poses import normalize_quaternions  # late: numba takes longer than a window

        rotations = np.array(self.local_rotations, dtype=np.float64, order="C", copy=None if own else True)
        translations = frozen_array(self.local_translations)
        if rotations.ndim != 3 or rotations.shape[2] != 4 or translations.shape != (*rotations.shape[:2], 3):
            raise StudioError(
                f"Poses need rotations (F, J, 4) and translations (F, J, 3), "
                f"not {rotations.shape} and {translations.shape}."
            )
        if len(rotations) == 0:
            raise StudioError("A motion needs at least one frame.")
        for array, kind in ((rotations, "rotation"), (translations, "translation")):
            if not np.isfinite(array).all():
                frame, joint = np.argwhere(~np.isfinite(array).all(axis=2))[0]
                raise StudioError(f"The {kind} of joint {joint} in frame {frame} is not a finite number.")
        if (np.einsum("fjk,fjk->fj", rotations, rotations) < 1e-12).any():
            raise StudioError("A rotation has a quaternion of length zero.")
        normalize_quaternions(rotations)
        for field, array in (("local_rotations", rotations), ("local_translations", translations)):
            array.setflags(write=False)
            object.__setattr__(self, field, array)

    @property
    def frame_count(self) -> int:
        """Number of frames F."""
        return len(self.local_rotations)

    @property
    def joint_count(self) -> int:
        """Number of joints J."""
        return int(self.local_rotations.shape[1])

    def frames(self, first: int, last: int) -> "PoseSequence":
        """Poses from frame ``first`` to ``last``, both included."""
        return PoseSequence(self.local_rotations[first : last + 1], self.local_translations[first : last + 1])

    def runs(self, length: int = 2048) -> "Iterator[tuple[slice, PoseSequence]]":
        """Yield the poses in runs of frames, so that callers can report progress on a long capture."""
        for first in range(0, self.frame_count, length):
            run = slice(first, first + length)
            yield run, PoseSequence(self.local_rotations[run], self.local_translations[run])
