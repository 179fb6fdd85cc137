"""Left for right: what is mirrored moves as its reflection does."""

from dataclasses import replace

import numpy as np

from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.normalized.mirror import mirrored_contacts, mirrored_motion
from studio.core.normalized.motion import Girdle
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from tests.builders import make_morphology
from tests.core.motions import swaying

REFLECTED = np.array([1.0, -1.0, 1.0])


def test_a_mirrored_motion_is_the_reflection_with_left_and_right_exchanged() -> None:
    motion, _ = normalize_capture(swaying(3, hinged=True))
    body = make_morphology(spine_count=4)
    layout = body.layout
    other_side = list(range(layout.point_count))
    for first in (layout.collar_point, layout.hip_point):
        left, right = (range(first(side), first(side) + 5) for side in range(2))
        for a, b in zip(left, right, strict=True):
            other_side[a], other_side[b] = b, a
    plain, _ = realize_motion(motion, body)
    seen, rotations = realize_motion(mirrored_motion(motion), body)
    np.testing.assert_allclose(seen[:, other_side] * REFLECTED, plain, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(rotations), 1.0, atol=1e-12)


def test_hands_and_feet_turn_as_their_reflections_do() -> None:
    motion, _ = normalize_capture(swaying(5, hinged=True))
    body = make_morphology()
    spine = body.layout.spine_count
    (_, plain), (_, seen) = realize_motion(motion, body), realize_motion(mirrored_motion(motion), body)
    for left, right, axes in ((spine + 5, spine + 9, [-1.0, 1.0, 1.0]), (spine + 12, spine + 16, [1.0, -1.0, 1.0])):
        np.testing.assert_allclose(np.diag(REFLECTED) @ seen[:, right] @ np.diag(axes), plain[:, left], atol=1e-12)


def test_mirrored_twice_is_the_motion_itself() -> None:
    motion, _ = normalize_capture(swaying(1))
    np.testing.assert_array_equal(mirrored_motion(mirrored_motion(motion)).channels, motion.channels)


def test_the_shoulders_of_a_mirrored_motion_are_mirrored() -> None:
    motion, _ = normalize_capture(swaying(3, hinged=True))
    steep = replace(make_morphology(), clavicle_rest=np.array([[0.0, 0.8, 0.6], [0.0, -1.0, 0.0]]))
    asked = replace(motion, girdle=Girdle(0.8, np.array([[0.1, 0.9, -0.4], [0.0, -1.0, 0.0]]), 0.2, np.full(4, 0.5)))
    plain, _ = realize_motion(asked, steep)
    seen, _ = realize_motion(
        mirrored_motion(asked), replace(steep, clavicle_rest=steep.clavicle_rest[::-1] * REFLECTED)
    )
    left, right = (steep.layout.collar_point(side) + 1 for side in range(2))
    np.testing.assert_allclose(seen[:, right] * REFLECTED, plain[:, left], atol=1e-12)


def test_contacts_are_those_of_the_other_side() -> None:
    seat, heel = (ContactInterval("m", point, 2, 5) for point in (ContactPoint.SEAT, ContactPoint.LEFT_HEEL))
    assert mirrored_contacts((seat, heel)) == (seat, ContactInterval("m", ContactPoint.RIGHT_HEEL, 2, 5))
