"""Behaviours are put into words that say where a point is."""

import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.panels.behaviour.words import point_name


@pytest.mark.parametrize(
    ("point", "words"),
    [
        (BodyPoint(BodyPart.PELVIS, (0.0, 0.0, 0.9)), "a point 0.90 m above the pelvis"),
        (BodyPoint(BodyPart.PELVIS, (-0.25, 0.0, 0.0)), "a point 0.25 m behind the pelvis"),
        (BodyPoint(BodyPart.HEAD, (0.0, 0.2, 0.1)), "a point 0.22 m left of the head"),
        (BodyPoint(BodyPart.RIGHT_FOREARM, (0.0, 0.0, 0.1), at_end=True), "a point 0.10 m off the right wrist"),
        (BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), "right wrist"),
    ],
)
def test_a_point_off_a_joint_is_named_by_its_distance_and_direction(point: BodyPoint, words: str) -> None:
    assert point_name(point) == words
