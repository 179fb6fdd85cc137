"""How many pixels a picture has while something moves."""

from studio.viewport.sharpness import PATIENCE, SHARES, SLOW, Sharpness

FULL = (900, 600)


def test_where_drawing_is_quick_every_picture_has_all_pixels() -> None:
    sharpness = Sharpness()
    for _ in range(100):
        sharpness.took(0.5 * SLOW)
    assert sharpness.size(FULL) == FULL


def test_where_drawing_is_slow_pictures_that_move_have_fewer_pixels_and_never_less_than_half() -> None:
    sharpness = Sharpness()
    for _ in range(100):
        sharpness.took(2.0 * SLOW)
    assert sharpness.size(FULL) == (450, 300)


def test_one_slow_picture_among_quick_ones_changes_nothing() -> None:
    sharpness = Sharpness()
    for _ in range(20):
        sharpness.took(3.0 * SLOW)
        sharpness.took(0.5 * SLOW)
    assert sharpness.size(FULL) == FULL


def test_after_a_rest_more_is_tried_again() -> None:
    sharpness = Sharpness()
    for _ in range(PATIENCE * len(SHARES)):
        sharpness.took(2.0 * SLOW)
    for _ in SHARES:
        sharpness.rest()
    assert sharpness.size(FULL) == FULL
