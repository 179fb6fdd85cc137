"""Read-only arrays, as frozen values hold them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def frozen_array(array: Any) -> NDArray[np.float64]:
    """``array`` as a read-only array of floats: itself if it is one already, else a copy."""
    kept = np.asarray(array, dtype=np.float64)
    if kept.flags.writeable or not kept.flags.owndata:
        kept = np.array(kept)
        kept.setflags(write=False)
    return kept
