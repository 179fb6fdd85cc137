"""A panel that puts all performers side by side, so many metres apart, as one undo step."""

from PySide6.QtWidgets import QDoubleSpinBox, QPushButton, QVBoxLayout, QWidget

from studio import api


def make(scene: api.Scene) -> QWidget:
    """A distance and a button."""
    panel = QWidget()
    column = QVBoxLayout(panel)
    distance = QDoubleSpinBox(minimum=0.5, maximum=10.0, value=1.5, suffix=" m")
    button = QPushButton("Space out")
    column.addWidget(distance)
    column.addWidget(button)
    column.addStretch(1)

    def space_out() -> None:
        with scene.undo_step("Space out performers"):
            for index, performer in enumerate(scene.project.performers):
                scene.change("performers", performer, position=(0.0, index * distance.value()))

    button.clicked.connect(space_out)
    return panel


PANEL = api.Panel("Spacing", make)
