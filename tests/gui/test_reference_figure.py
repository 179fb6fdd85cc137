"""The picture of a capture's body at ease in its import report."""

import numpy as np
import pytest
from PySide6.QtGui import QColor, QImage
from pytestqt.qtbot import QtBot

from studio.core.body.humanoid import BodyPart
from studio.document.colours import LEFT, RIGHT
from studio.panels.body_map_section import body_of_capture
from studio.panels.joint_figure import JointFigure
from studio.panels.reference_figure import ReferenceFigure
from studio.panels.thumbnails import capture_picture
from tests.builders import make_capture
from tests.far_roots import with_far_root


def _columns(image: QImage, colour: str, width: int) -> np.ndarray:
    """Columns of pixels of a colour in the left ``width`` of an image."""
    wanted = QColor(colour).rgb()
    found = [(x, y) for x in range(width) for y in range(image.height()) if image.pixel(x, y) == wanted]
    return np.array([x for x, _ in found])


@pytest.fixture
def image(qtbot: QtBot) -> QImage:
    """The figure of a body, 400 pixels wide and 160 high."""
    capture = make_capture()
    assert capture.body_map is not None
    figure = ReferenceFigure(capture, capture.body_map)
    qtbot.addWidget(figure)
    figure.resize(400, 160)
    return figure.grab().toImage()


def test_the_body_is_seen_from_behind_with_its_left_at_the_left_as_in_the_figure_of_joints(
    image: QImage, qtbot: QtBot
) -> None:
    """They showed opposite sides, one above the other in one form."""
    capture = make_capture()
    body, joints = body_of_capture(capture), JointFigure()
    qtbot.addWidget(joints)
    joints.resize(200, 190)
    assert body is not None
    joints.show_body(body.skeleton, body.positions, body.body_map, None)
    for picture in (image, joints.grab().toImage()):
        left, right = (_columns(picture, colour, 200) for colour in (LEFT, RIGHT))
        assert len(left)
        assert len(right)
        assert left.mean() < right.mean() - 20


def test_the_body_stands_on_a_line_and_the_way_up_is_named(image: QImage) -> None:
    background = image.pixel(1, 1)
    drawn = np.array([[image.pixel(x, y) != background for x in range(200)] for y in range(160)])
    floor = np.flatnonzero(drawn[:, 20:180].sum(axis=1) > 140)
    feet = max(
        y for x in range(200) for y in range(160) if image.pixel(x, y) in (QColor(LEFT).rgb(), QColor(RIGHT).rgb())
    )
    assert np.abs(floor - feet).min() <= 2
    assert drawn[70:90, 5:60].any()  # "Up", halfway up at the left edge
    assert not drawn[100:115, 5:60].any()


@pytest.mark.parametrize("exchanged", [False, True])
def test_toes_show_whether_sides_are_exchanged(qtbot: QtBot, exchanged: bool) -> None:
    capture = make_capture()
    assert capture.body_map is not None
    body_map = capture.body_map.with_sides_exchanged() if exchanged else capture.body_map
    figure = ReferenceFigure(capture, body_map)
    qtbot.addWidget(figure)
    figure.resize(400, 160)
    columns = _columns(figure.grab().toImage(), LEFT, 400)
    side_view = columns[columns >= 200]
    leg = np.median(side_view)
    assert (side_view.max() - leg > leg - side_view.min()) == exchanged


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)])
def test_a_root_that_is_far_from_the_body_changes_nothing_in_the_figures(qtbot: QtBot, direction) -> None:
    capture = make_capture()
    far = with_far_root(capture, 4.0 * np.array(direction))
    figures = [ReferenceFigure(each, each.body_map) for each in (capture, far)]
    for figure in figures:
        qtbot.addWidget(figure)
        figure.resize(400, 160)
    shown, same = (figure.grab().toImage() for figure in figures)
    assert shown == same
    assert capture_picture(capture) == capture_picture(far)
    joints = [JointFigure(), JointFigure()]
    for widget, each in zip(joints, (capture, far), strict=True):
        qtbot.addWidget(widget)
        body = body_of_capture(each)
        widget.show_body(body.skeleton, body.positions, body.body_map, None)
    head = capture.skeleton.names[capture.body_map[BodyPart.HEAD]]
    apart = joints[0].place_of(head) - joints[1].place_of(head)
    assert apart.manhattanLength() < 0.1
