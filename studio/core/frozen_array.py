"""Arrays that values hold: nobody writes to them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def unwritten(array: Any) -> NDArray[np.float64]:
    """``array`` as numbers that nobody can write to: itself if that is so already, a copy else."""
    kept = np.asarray(array, dtype=np.float64)
    if kept.flags.writeable or not kept.flags.owndata:
        kept = np.array(kept)
        kept.setflags(write=False)
    return kept
