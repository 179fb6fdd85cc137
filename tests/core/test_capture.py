"""A capture agrees with itself, and what the user overrules is no longer a guess."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.humanoid import BodyPart
from studio.core.captures.capture import Capture, Guess
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from tests.builders import BODY_MAP, make_capture


def test_what_the_user_overrules_is_no_longer_a_guess() -> None:
    guesses = (Guess("floor", "0 m", "near zero"), Guess("unit", "cm", "legs"))
    capture = replace(make_capture(), guesses=guesses).with_floor(-0.2)
    assert capture.floor == -0.2
    assert [guess.subject for guess in capture.guesses] == ["unit"]


def test_body_map_rate_and_start_can_be_overruled() -> None:
    capture = make_capture()
    changed = capture.with_body_map(BODY_MAP | {"head": "Neck", "neck": "Neck"})
    assert changed.body_map is not None
    assert capture.skeleton.names[changed.body_map[BodyPart.HEAD]] == "Neck"
    assert capture.with_frame_rate(24.0).frame_rate == 24.0
    assert capture.with_first_frame(1).duration == pytest.approx((capture.frame_count - 2) / capture.frame_rate)


def test_whole_numbers_become_those_that_kernels_are_compiled_for() -> None:
    capture = make_capture().with_frame_rate(24).with_floor(0)
    assert [type(each) for each in (capture.frame_rate, capture.floor)] == [float, float]
    motion, _ = normalize_capture(capture)
    assert type(replace(motion, frame_rate=30).frame_rate) is float


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"frame_rate": 0.0}, "frame rate or the floor"),
        ({"floor": np.nan}, "frame rate or the floor"),
        ({"first_frame": 10_000}, "has no frame 10000"),
        ({"reference_rotations": np.zeros((2, 4))}, "do not fit"),
    ],
)
def test_a_capture_that_contradicts_itself_is_refused(changes: dict[str, object], sentence: str) -> None:
    capture: Capture = make_capture()
    with pytest.raises(StudioError, match=sentence):
        replace(capture, **changes)  # type: ignore[arg-type]
