"""Panel of saved poses: thumbnails, the body region to which a pose is applied, and the blend."""

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QMimeData, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from studio.document.dragging import POSE_MIME, row_drag_data
from studio.panels.fields import PER_CENT, Choice, press_button, styled_label
from studio.panels.sliders import ValueSlider
from studio.panels.thumbnails import THUMBNAIL_PIXELS

NO_POSES_HINT = "No pose is saved yet. Save pose stores the selected character's pose at the playhead."


class PoseList(QListWidget):
    """List of saved poses with thumbnails, which can be dragged onto a character."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("pictures")
        self.setAccessibleName("Saved poses")
        self.setViewMode(QListWidget.ViewMode.IconMode)
        self.setMovement(QListWidget.Movement.Static)
        self.setResizeMode(QListWidget.ResizeMode.Adjust)
        self.setIconSize(QSize(THUMBNAIL_PIXELS, THUMBNAIL_PIXELS))
        self.setGridSize(QSize(THUMBNAIL_PIXELS + 16, THUMBNAIL_PIXELS + 28))
        self.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.setWordWrap(False)
        self.setDragEnabled(True)
        self.setEditTriggers(QListWidget.EditTrigger.EditKeyPressed)

    def mimeTypes(self) -> list[str]:
        return [POSE_MIME]

    def mimeData(self, items: Sequence[QListWidgetItem]) -> QMimeData:
        """MIME data with the index of the dragged pose."""
        return row_drag_data(POSE_MIME, self.row(items[0]))


class PosePanel(QWidget):
    """Panel of saved poses; its signals carry the row of a pose in the list."""

    save_requested = Signal()
    apply_requested = Signal(int)
    delete_requested = Signal(int)
    pose_renamed = Signal(int, str)

    def __init__(self, regions: Iterable[str]) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.poses = PoseList()
        self.poses.itemActivated.connect(lambda item: self.apply_requested.emit(self.poses.row(item)))
        self.poses.itemChanged.connect(self._item_changed)
        self.poses.currentRowChanged.connect(self._row_changed)
        self._hint = styled_label("", "hint")
        self.save = press_button("Save pose", self.save_requested.emit)
        self.save.setToolTip("Save the pose of the selected character at the playhead")
        self.delete = press_button("Delete pose", lambda: self.delete_requested.emit(self.poses.currentRow()))
        self.delete.setToolTip("Delete the file of this pose")
        self.region = Choice("Body region", [(region, region) for region in regions])
        self.blend = ValueSlider("Blend", 0.0, 1.0)
        self.blend.edited.connect(self.set_blend)
        self.blend.restored.connect(lambda: self.set_blend(1.0))
        self.apply = press_button("Apply pose", lambda: self.apply_requested.emit(self.poses.currentRow()), "primary")
        self.apply.setToolTip(
            "Set a correction key at the playhead that matches this pose in the region; or drag a pose onto a"
            " character."
        )
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 8, 12, 8)
        column.addWidget(self._hint)
        column.addWidget(self.poses, 1)
        for widgets in ((self.save, self.delete), (self.region, self.blend), (self.apply,)):
            row = QHBoxLayout()
            for widget in widgets:
                row.addWidget(widget, 1)
            column.addLayout(row)
        self.set_blend(1.0)
        self.show_poses((), ())

    @property
    def fraction(self) -> float:
        """Blend weight of the pose, from 0 to 1."""
        return self._fraction

    def set_blend(self, fraction: float) -> None:
        """Set the slider of the blend weight, from 0 to 1."""
        self._fraction = fraction
        self.blend.show_value(fraction, f"{PER_CENT * fraction:.0f} %")

    def show_poses(self, poses: Sequence[tuple[str, QIcon]], problems: Sequence[str], current: int = -1) -> None:
        """List poses by name and thumbnail, and messages about unreadable files; ``current`` is the row to select."""
        with QSignalBlocker(self.poses):
            self.poses.clear()
            for name, picture in poses:
                item = QListWidgetItem(picture, name)
                item.setFlags(item.flags() | Qt.ItemFlag.ItemIsEditable)
                item.setToolTip(f"{name}. Double-click to apply, F2 to rename, or drag it onto a character")
                self.poses.addItem(item)
            self.poses.setCurrentRow(current)
        self._hint.setText("\n".join(problems) if poses or problems else NO_POSES_HINT)
        self._hint.setVisible(bool(self._hint.text()))
        self._row_changed(current)

    def edit_name(self, row: int) -> None:
        """Let the user edit the name of a pose in the list."""
        self.poses.setFocus()
        self.poses.editItem(self.poses.item(row))

    def _item_changed(self, item: QListWidgetItem) -> None:
        """Emit the new name after its editor is closed, because the list may be refilled then."""
        row, name = self.poses.row(item), item.text().strip()
        QTimer.singleShot(0, self, lambda: self.pose_renamed.emit(row, name))

    def _row_changed(self, row: int) -> None:
        for button in (self.delete, self.apply):
            button.setEnabled(row >= 0)
