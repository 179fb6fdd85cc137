"""Windows that slide over tracks are those of SciPy, which the reading of captures does without."""

import numpy as np
import pytest
from scipy import ndimage

from studio.core.windows import bell_average, highest, lowest


@pytest.mark.parametrize("frames", [1, 2, 7, 300])
@pytest.mark.parametrize("sigma", [0.0, 0.4, 3.0, 60.0])
def test_a_track_is_smoothed_as_scipy_does_with_its_ends_held(frames: int, sigma: float) -> None:
    track = np.random.default_rng(frames).normal(size=(frames, 3))
    expected = ndimage.gaussian_filter1d(track, sigma, axis=0, mode="nearest") if sigma else track
    np.testing.assert_allclose(bell_average(track, sigma), expected, atol=1e-14)
    np.testing.assert_allclose(bell_average(track[:, 0], sigma), expected[:, 0], atol=1e-14)


@pytest.mark.parametrize("frames", [1, 5, 200])
@pytest.mark.parametrize("reach", [0, 1, 30])
def test_the_highest_and_the_lowest_of_a_window_are_scipys(frames: int, reach: int) -> None:
    track = np.random.default_rng(reach).normal(size=frames)
    np.testing.assert_array_equal(highest(track, reach), ndimage.maximum_filter1d(track, 2 * reach + 1, mode="nearest"))
    np.testing.assert_array_equal(lowest(track, reach), ndimage.minimum_filter1d(track, 2 * reach + 1, mode="nearest"))
    assert highest(track > 0.0, reach).dtype == bool
