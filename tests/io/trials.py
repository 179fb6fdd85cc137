"""Made trials for the tests of C3D: a few markers, signals, a plate, events; all different numbers."""

import numpy as np

from studio.core.markers.trial import AnalogSignals, ForcePlate, Trial, TrialEvent

FRAMES, SAMPLES = 12, 4


def make_trial(labels: tuple[str, ...] = ("LASI", "RASI", "LKNE", "LKneeAngles"), frames: int = FRAMES) -> Trial:
    """Points to single precision, as a file keeps them; the second one is not seen in frames 3 to 5."""
    random = np.random.default_rng(7)
    points = random.normal(0.0, 500.0, (frames, len(labels), 3)).astype(np.float32).astype(float)
    points[3:6, 1] = np.nan
    residuals = np.where(np.isnan(points).any(axis=-1), -1.0, 0.0)
    samples = random.normal(0.0, 50.0, (frames * SAMPLES, 6)).astype(np.float32).astype(float)
    corners = np.array([[0.0, 0.0, 0.0], [400.0, 0.0, 0.0], [400.0, 600.0, 0.0], [0.0, 600.0, 0.0]])
    return Trial(
        name="take",
        source="take.c3d",
        labels=labels,
        kinds=tuple("angle" if label.endswith("Angles") else "marker" for label in labels),
        points=points,
        residuals=residuals,
        frame_rate=100.0,
        first_frame=7,
        unit="mm",
        analog=AnalogSignals(
            ("Fx1", "Fy1", "Fz1", "Mx1", "My1", "Mz1"),
            ("N", "N", "N", "Nmm", "Nmm", "Nmm"),
            100.0 * SAMPLES,
            samples,
        ),
        plates=(ForcePlate(2, corners, np.array([0.0, 0.0, -40.0]), (0, 1, 2, 3, 4, 5)),),
        events=(TrialEvent("Foot Strike", "Left", 0.09375), TrialEvent("Foot Off", "Right", 0.125)),
        measures={"LKNEEWIDTH": 105.0},
    )


def same(first: Trial, second: Trial) -> bool:
    """Equal in everything that a file keeps."""
    arrays = [(getattr(first, field), getattr(second, field)) for field in ("points", "residuals")] + [
        (first.analog.samples, second.analog.samples)
    ]
    arrays += [(one.corners, other.corners) for one, other in zip(first.plates, second.plates, strict=True)]
    fields = ("labels", "kinds", "frame_rate", "first_frame", "unit", "events", "measures")
    return all(np.array_equal(*pair, equal_nan=True) for pair in arrays) and all(
        getattr(first, field) == getattr(second, field) for field in fields
    )
