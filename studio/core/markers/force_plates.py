"""What force plates measured: the force on each plate, in its own axes, from the analog channels that it feeds."""

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.trial import ForcePlate, Trial

FloatArray = NDArray[np.float64]


def plate_force(trial: Trial, plate: ForcePlate) -> FloatArray:
    """(N, 3) in the units of the channels: along x and y of the plate, and down into it.

    Kinds 1 and 2 give the force itself, 3 has eight sensors (x12, x34, y14, y23, z1 to z4), 4 needs its calibration.
    """
    raw = trial.analog.samples[:, list(plate.channels)]
    if plate.kind == 3:
        x, y = raw[:, 0] + raw[:, 1], raw[:, 2] + raw[:, 3]
        return np.stack([x, y, raw[:, 4:8].sum(axis=1)], axis=1)
    if plate.kind == 4 and plate.calibration is not None:
        raw = raw @ plate.calibration.T
    return np.asarray(raw[:, :3])


def sample_times(trial: Trial) -> FloatArray:
    """(N,) seconds of the analog samples from frame 0 of the trial."""
    return np.arange(len(trial.analog.samples)) / trial.analog.rate
