"""A motion that is only looked at plays over the picture and changes nothing else."""

import numpy as np
from PySide6.QtWidgets import QWidget

from studio.viewport.preview import PREVIEW_HELD_PICTURES, PREVIEW_PICTURES, Preview


def test_it_goes_to_the_end_holds_it_and_begins_again(qtbot):
    widget = QWidget()
    qtbot.addWidget(widget)
    preview, points = Preview(widget), np.arange(30.0)[:, None, None] * np.ones((30, 4, 3))
    assert preview.points is None
    preview.show(points, np.zeros((0, 2), dtype=np.intp))
    seen = [float(preview.points[0, 0])]
    for _ in range(PREVIEW_PICTURES + PREVIEW_HELD_PICTURES):
        preview._go_on()
        seen.append(float(preview.points[0, 0]))
    assert seen[: PREVIEW_PICTURES + 1] == sorted(seen[: PREVIEW_PICTURES + 1])
    assert seen[PREVIEW_PICTURES : PREVIEW_PICTURES + PREVIEW_HELD_PICTURES] == [29.0] * PREVIEW_HELD_PICTURES
    assert seen[-1] == 0.0
    preview.show(None)
    assert preview.points is None
