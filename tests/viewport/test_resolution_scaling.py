"""Pixels of a picture while something moves."""

from itertools import pairwise

from studio.viewport.resolution_scaling import (
    FAST_FRAMES_BEFORE_RETRY,
    RESOLUTION_FRACTIONS,
    SLOW_PICTURES,
    ResolutionScaling,
)

FULL, SLOW = (900, 600), 0.02


def test_where_drawing_is_quick_every_picture_has_all_pixels() -> None:
    sharpness = ResolutionScaling(SLOW)
    for _ in range(100):
        sharpness.note_duration(0.5 * SLOW)
    assert sharpness.size(FULL) == FULL


def test_where_drawing_is_slow_pictures_that_move_have_fewer_pixels_and_never_less_than_half() -> None:
    sharpness = ResolutionScaling(SLOW)
    for _ in range(100):
        sharpness.note_duration(2.0 * SLOW)
    assert sharpness.size(FULL) == (450, 300)


def test_slow_pictures_now_and_then_among_quick_ones_change_nothing() -> None:
    sharpness = ResolutionScaling(SLOW)
    for _ in range(100):
        sharpness.note_duration(3.0 * SLOW)
        for _ in range(5):
            sharpness.note_duration(0.5 * SLOW)
    assert sharpness.size(FULL) == FULL


def test_after_a_rest_more_is_tried_again() -> None:
    sharpness = ResolutionScaling(SLOW)
    for _ in range(SLOW_PICTURES * len(RESOLUTION_FRACTIONS)):
        sharpness.note_duration(2.0 * SLOW)
    for _ in RESOLUTION_FRACTIONS:
        sharpness.note_rest()
    assert sharpness.size(FULL) == FULL


def test_after_a_slow_while_all_pixels_come_back_though_nothing_rests() -> None:
    sharpness = ResolutionScaling(SLOW)
    for _ in range(SLOW_PICTURES):
        sharpness.note_duration(2.0 * SLOW)
    for _ in range(2 * FAST_FRAMES_BEFORE_RETRY):
        sharpness.note_duration(0.6 * SLOW)
    assert sharpness.size(FULL) == FULL


def test_pixels_that_were_too_many_are_tried_ever_more_seldom() -> None:
    sharpness = ResolutionScaling(SLOW)
    sizes: list[tuple[int, int]] = []
    for _ in range(3000):
        sharpness.note_duration(1.2 * SLOW if sharpness.size(FULL) == FULL else 0.6 * SLOW)
        sizes.append(sharpness.size(FULL))
    assert sum(a != b for a, b in pairwise(sizes)) <= 12
