"""Forces on plates, against the weight of who walks over them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.markers.force_plates import plate_force, sample_times
from studio.core.markers.trial import AnalogSignals, ForcePlate
from studio.io.c3d import read_c3d
from tests.io.trials import make_trial


@pytest.mark.parametrize("name", ["btk_PiG_FullBody_walk", "btk_PiG_LowerBody_walk"])
def test_a_step_presses_with_about_the_weight_of_the_body(captures: Path, name: str) -> None:
    trial = read_c3d(captures / "c3d" / f"{name}.c3d").trial
    weight = trial.measures["BODYMASS"] * 9.81
    for plate in trial.plates:
        assert weight < np.abs(plate_force(trial, plate)[:, 2]).max() < 1.4 * weight
    assert sample_times(trial)[-1] == pytest.approx(trial.frame_count / trial.frame_rate, abs=0.01)


def test_a_calibrated_plate_mixes_its_channels_and_eight_sensors_are_summed() -> None:
    trial = make_trial()
    corners = trial.plates[0].corners
    swap = np.eye(6)[[1, 0, 2, 3, 4, 5]]
    calibrated = ForcePlate(4, corners, np.zeros(3), tuple(range(6)), swap)
    np.testing.assert_allclose(plate_force(trial, calibrated), trial.analog.samples[:, [1, 0, 2]])
    ones = AnalogSignals(tuple("abcdefgh"), ("N",) * 8, 400.0, np.tile(np.arange(8.0), (48, 1)))
    eight = ForcePlate(3, corners, np.zeros(3), tuple(range(8)))
    np.testing.assert_allclose(plate_force(replace(trial, analog=ones), eight), np.tile([1.0, 5.0, 22.0], (48, 1)))
