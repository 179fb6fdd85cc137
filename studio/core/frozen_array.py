"""Read-only arrays for the fields of frozen records."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def frozen_array(array: Any) -> NDArray[np.float64]:
    """Read-only array of floats: ``array`` itself if it is one already, else a copy."""
    kept = np.asarray(array, dtype=np.float64)
    if kept.flags.writeable or not kept.flags.owndata:
        kept = np.array(kept)
        kept.setflags(write=False)
    return kept
