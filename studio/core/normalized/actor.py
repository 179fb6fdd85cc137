"""Actor of a capture: its measures, and the relation of its own joints to the canonical segments."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SourceRig:
    """Everything in a capture except its motion; with it the capture can be restored from its normalised motion.

    ``segment_joints`` (S,) is the source joint whose rotation moves each canonical segment, or -1 if the capture has
    none and the segment moves with its parent. ``alignments`` (S, 3, 3) satisfy R_canonical = R_joint A. ``origin``
    (3,) is that of the motion's space in the capture's. ``pass_through`` are the source's local poses, of which only
    joints without a segment (fingers, eyes, twist bones) are used.
    """

    skeleton: Skeleton
    morphology: Morphology
    segment_joints: NDArray[np.int64]
    alignments: FloatArray
    origin: FloatArray
    pass_through: PoseSequence
