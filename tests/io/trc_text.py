"""TRC files made from trials, in the dialects that programs write."""

import numpy as np

from studio.core.markers.trial import Trial

KEYS = "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames"


def trc_text(trial: Trial, between: str = "\t", gap: str = "", unit: str | None = None, blank: bool = True) -> str:
    """``trial`` as Cortex writes it; ``gap`` stands for a number that was not seen."""
    count = len(trial.labels)
    axes = between.join(f"{axis}{index}" for index in range(1, count + 1) for axis in "XYZ")
    rate = f"{trial.frame_rate:g}"
    lines = [
        "PathFileType\t4\t(X/Y/Z)\ttake.trc",
        KEYS,
        "\t".join(
            (rate, rate, str(trial.frame_count), str(count), unit or trial.unit, rate, "1", str(trial.frame_count))
        ),
        "Frame#\tTime\t" + "\t\t\t".join(trial.labels) + "\t\t",
        f"\t\t{axes}",
        *([""] if blank else []),
    ]
    for frame, points in enumerate(trial.points):
        cells = [gap if np.isnan(value) else f"{value:.6f}" for value in points.ravel()]
        lines.append(between.join([str(trial.first_frame + frame), f"{frame / trial.frame_rate:.5f}", *cells]))
    return "\n".join(lines) + "\n"
