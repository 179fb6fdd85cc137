"""Forces on plates, against the weight of who walks over them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from studio.core.markers.force_plates import plate_force, plate_loads, plate_reactions, plates_height, sample_times
from studio.core.markers.trial import TRIAL_UNIT_METRES, AnalogSignals, ForcePlate
from studio.io.c3d.reader import read_c3d
from studio.io.c3d.writer import write_c3d
from tests.io.trials import make_trial

FloatArray = NDArray[np.float64]


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


CORNERS = np.array([[0.6, 0.4, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.0], [0.6, 0.0, 0.0]])
PUSHED_AT = np.array([0.4, 0.1, 0.0])


def pressed(kind: int, sign: float) -> tuple[FloatArray, FloatArray]:
    """Place and force of the ground when 700 N press on ``PUSHED_AT``, told by a plate of some kind.

    Its x and y run along those of the file; the sensors of kinds 2 and 4 lie 4 cm below the surface.
    """
    x, y = PUSHED_AT[:2] - [0.3, 0.2]
    force = np.array([30.0, -20.0, 700.0])
    if kind == 3:
        a, b = 0.25, 0.15
        along, across = x / a, y / b
        loads = 175.0 * np.array([
            (1 + along) * (1 + across), (1 - along) * (1 + across),
            (1 - along) * (1 - across), (1 + along) * (1 - across),
        ])  # fmt: skip
        channels, origin = np.array([30.0, 0.0, -20.0, 0.0, *loads]), np.array([a, b, 0.0])
    elif kind == 1:
        channels, origin = np.array([*force, x, y, 0.0]), np.array([0.0, 0.0, 0.04])
    else:
        turning = np.array([y * force[2] + 0.04 * force[1], -x * force[2] - 0.04 * force[0], 0.0])
        channels, origin = np.array([*force, *turning]), np.array([0.0, 0.0, -0.04])
    samples = np.stack([sign * channels, np.zeros_like(channels)])
    if kind == 1:
        samples[0, 3:5] = x, y
    labels = tuple("abcdefgh"[: len(channels)])
    trial = replace(make_trial(), analog=AnalogSignals(labels, ("N",) * len(labels), 100.0, samples))
    return plate_reactions(trial, ForcePlate(kind, CORNERS, origin, tuple(range(len(labels)))))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_the_ground_pushes_up_where_the_foot_presses(kind: int, sign: float) -> None:
    places, forces = pressed(kind, sign)
    np.testing.assert_allclose(places[0], PUSHED_AT, atol=1e-9)
    np.testing.assert_allclose(np.abs(forces[0]), [30.0, 20.0, 700.0])
    assert forces[0, 2] == 700.0
    assert np.isnan(places[1]).all()
    assert np.isnan(forces[1]).all()


def test_a_plate_without_an_area_pushes_nobody() -> None:
    trial = make_trial()
    flat = ForcePlate(2, np.zeros((4, 3)), np.zeros(3), tuple(range(6)))
    assert np.isnan(plate_reactions(trial, flat)).all()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("offset", [0.0, 33.0])
def test_steps_on_a_plate_are_those_frames_in_which_it_is_loaded(sign: float, offset: float) -> None:
    """480 samples at 400 Hz of 120 frames; a plate that is never empty, or never trodden on, shows no step."""
    force = np.zeros((480, 6))
    force[120:320, 2] = 700.0
    plate = ForcePlate(2, 1000.0 * CORNERS, np.zeros(3), tuple(range(6)))

    def steps(pushes: FloatArray) -> list[tuple[int, int]]:
        analog = AnalogSignals(tuple("abcdef"), ("N",) * 6, 400.0, sign * pushes + offset)
        trial = replace(make_trial(), analog=analog, plates=(plate,))
        return [(load.first, load.last) for load in plate_loads(trial, np.eye(3))]

    assert steps(force) == [(30, 79)]
    assert steps(force[120:320]) == []
    assert steps(0.01 * force) == []


@pytest.mark.parametrize("unit", ["m", "mm", "cm", "inch"])
@pytest.mark.parametrize("said", ["m", "mm"])
def test_corners_in_another_unit_than_the_points_still_say_where_the_floor_is(unit: str, said: str) -> None:
    corners = (CORNERS + np.array([0.0, 0.0, 0.5])) / TRIAL_UNIT_METRES[unit]
    trial = replace(make_trial(), unit=said, plates=(ForcePlate(2, corners, np.zeros(3), tuple(range(6))),))
    assert trial.metres_of_plates == TRIAL_UNIT_METRES[unit]
    assert plates_height(trial, np.eye(3), 0.52) == pytest.approx(0.5)


def test_a_plate_without_signals_says_where_the_floor_is_and_pushes_nobody(tmp_path: Path) -> None:
    trial = replace(make_trial(), plates=(ForcePlate(0, 1000.0 * CORNERS + [0.0, 0.0, 500.0], np.zeros(3), ()),))
    write_c3d(tmp_path / "take.c3d", trial)
    again = read_c3d(tmp_path / "take.c3d").trial
    assert [plate.channels for plate in again.plates] == [()]
    assert plates_height(again, np.eye(3), 0.52) == pytest.approx(0.5)
    assert plate_loads(again, np.eye(3)) == ()
