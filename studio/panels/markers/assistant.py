"""Editor of a marker map: the map on a figure of the body, beside the markers of the trial."""

from collections.abc import Mapping

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QTreeWidget, QTreeWidgetItem, QVBoxLayout, QWidget

from studio.core.markers.marker_map import MarkerMap, seen_labels
from studio.core.markers.roles import ROLES, ROLES_BY_ID, SIDE_WORDS
from studio.core.markers.take import MarkerTake
from studio.core.markers.trial import label_without_subject, seen_mask, subject_of
from studio.document import colours
from studio.io.markers.maps import find_map, fitted_map, known_maps, save_map
from studio.panels.fields import FIELD_ICON_PX, Choice, Section, press_button, styled_label
from studio.panels.markers.cloud import MarkerCloud
from studio.panels.markers.marker_figure import MarkerFigure

NOT_USED_TEXT = "-"


class MarkerAssistant(QWidget):
    """Editor of a marker map: choose a body location on the figure, then its marker in the list, or the other way
    round.
    """

    changed = Signal()
    """Emitted when the map or the subject has changed."""
    marked = Signal(object)
    """Emitted with the labels, without subject, of the markers at the chosen body location."""

    def __init__(self, take: MarkerTake, up_axis: str) -> None:
        super().__init__()
        self._trial = take.trial
        self.subject, self.marker_map = take.subject, take.marker_map
        self._role = ""
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(0)
        self.figure = MarkerFigure()
        self.figure.role_chosen.connect(self.choose_role)
        row.addWidget(self.figure, 0, Qt.AlignmentFlag.AlignTop)
        self.cloud = MarkerCloud(take.trial, up_axis)
        self.cloud.marker_chosen.connect(self.put_marker)
        row.addWidget(self.cloud)
        column = QVBoxLayout()
        row.addLayout(column, 1)
        column.addWidget(self._make_maps())
        column.addWidget(self._make_place())
        column.addWidget(self._make_list(), 1)
        self._fill()
        self._face()
        self.choose_role(next((role.id for role in ROLES if role.id not in self.marker_map.markers), ROLES[0].id))

    def _make_maps(self) -> Section:
        section = Section("Marker map")
        self._maps = Choice("Marker map", [])
        self._maps.setPlaceholderText("Load another map…")
        self._maps.value_chosen.connect(self._take_map)
        self.name = QLineEdit(self.marker_map.name)
        self.name.setAccessibleName("Name of the marker map")
        self._save = press_button("Save map", self.save)
        self._save.setToolTip("Save as the default marker map of files with these markers")
        subjects = sorted({subject_of(label) for label in self._trial.markers} - {""})
        self._subjects = Choice("Subject", [("", "All markers"), *((name, name) for name in subjects)])
        self._subjects.show_value(self.subject)
        self._subjects.value_chosen.connect(self._take_subject)
        if len(subjects) > 1:
            section.add_row("Subject", self._subjects)
        section.add_row("Use", self._maps)
        section.add_row("Name", self.name, self._save)
        self._fill_maps()
        return section

    def _make_place(self) -> Section:
        section = Section("Body location")
        self._place, self._hint = styled_label("", "title"), styled_label("", "hint")
        self._clear = press_button("Clear", self.clear_role, "link")
        self._clear.setToolTip("Unassign the marker")
        section.head.addWidget(self._clear)
        section.add_wide(self._place)
        section.add_wide(self._hint)
        return section

    def _make_list(self) -> QWidget:
        box = QWidget()
        column = QVBoxLayout(box)
        column.setContentsMargins(FIELD_ICON_PX, 8, FIELD_ICON_PX, 0)
        self.list = QTreeWidget()
        self.list.setHeaderLabels(["Marker", "Body location", "Visible"])
        self.list.setRootIsDecorated(False)
        self.list.setUniformRowHeights(True)
        self.list.setAccessibleName("Markers of the trial; click one to assign it to the selected body location")
        self.list.itemClicked.connect(lambda item, _: self.put_marker(item.text(0)))
        column.addWidget(self.list)
        return box

    @property
    def summary(self) -> str:
        """Sentence about the limbs that the marker map can solve, or the missing markers."""
        there = self.marker_map.restricted_to(self._labels())
        parts = [word for word, has in (("legs", there.has_legs()), ("arms", there.has_arms())) if has]
        if len(parts) == 2:
            return "Legs and arms can be solved."
        if parts:
            other = "arms" if parts == ["legs"] else "legs"
            return f"The {parts[0]} can be solved; the {other} will stay in the rest pose."
        lacking, more = there.missing_positions()[:4], len(there.missing_positions()) > 4
        return f"The skeleton cannot be solved yet. Still missing: {', '.join(lacking)}{' and others' if more else ''}."

    def choose_role(self, role: str) -> None:
        """Choose a body location: show its markers, and assign the next clicked marker to it."""
        self._role = role
        self._show()

    def put_marker(self, label: str) -> None:
        """Assign a marker to the chosen body location, or unassign it if it is assigned there.

        Thighs and shanks have clusters of several markers, from which the rotation of the bone is solved; other
        locations have one.
        """
        own = self.marker_map.markers.get(self._role, ())
        cluster = self._role.endswith(("thigh", "shank"))
        if label in own:
            labels = tuple(each for each in own if each != label)
        else:
            labels = (*own, label) if cluster else (label,)
        self._set(self.marker_map.with_role(self._role, labels))

    def clear_role(self) -> None:
        """Unassign all markers of the chosen body location."""
        self._set(self.marker_map.with_role(self._role, ()))

    def save(self) -> None:
        """Save the map under its name in the user's folder."""
        name = self.name.text().strip() or "My markers"
        self.marker_map = MarkerMap(name, self.marker_map.markers, self.marker_map.centres)
        path = save_map(self.marker_map)
        self._fill_maps()
        self._hint.setText(f"Saved as {path.name}; it will be used for every file with these markers.")

    def _set(self, marker_map: MarkerMap) -> None:
        self.marker_map = marker_map
        self._show()
        self.changed.emit()

    def _take_map(self, chosen: object) -> None:
        if chosen == "propose":
            self.marker_map = find_map(self._trial, self.subject)
        else:
            assert isinstance(chosen, MarkerMap)
            self.marker_map = fitted_map(chosen, self._labels())
        with QSignalBlocker(self.name):
            self.name.setText(self.marker_map.name)
        self._set(self.marker_map)

    def _take_subject(self, subject: object) -> None:
        self.subject = str(subject)
        self.marker_map = find_map(self._trial, self.subject)
        self._fill()
        self._set(self.marker_map)

    def _labels(self) -> list[str]:
        return list(seen_labels(self._trial, self.subject, ("marker", "virtual")).values())

    def _fill_maps(self) -> None:
        self._maps.clear_all()
        self._maps.add("propose", "Best match")
        for known in known_maps():
            self._maps.add(known, known.name)
        self._maps.setCurrentIndex(-1)

    def _fill(self) -> None:
        self.list.clear()
        for label, bare in seen_labels(self._trial, self.subject).items():
            share = float(seen_mask(self._trial.track(label)).mean())
            item = QTreeWidgetItem([label_without_subject(bare), "", f"{100 * share:.0f} %"])
            item.setTextAlignment(2, Qt.AlignmentFlag.AlignRight)
            self.list.addTopLevelItem(item)

    def _face(self) -> None:
        """Show the recorded markers from behind, as the figure is."""
        self.cloud.show_markers(tuple(seen_labels(self._trial, self.subject)), (), ())
        left, right = (
            {label for role, labels in self.marker_map.markers.items() if role.startswith(side) for label in labels}
            for side in SIDE_WORDS
        )
        self.cloud.face(left - right, right - left)

    def _show(self) -> None:
        markers = self.marker_map.markers
        self.figure.show_map(markers, self._role)
        role = ROLES_BY_ID[self._role]
        own = markers.get(self._role, ())
        self.marked.emit(own)
        self._place.setText(f"{role.words}: {', '.join(own) if own else 'no marker'}")
        self._hint.setText(f"{role.hint}. Click its marker in the list or among the recorded ones.")
        self._clear.setEnabled(bool(own))
        self.cloud.show_markers(tuple(seen_labels(self._trial, self.subject)), self.marker_map.labels, own)
        self._show_list(markers, own)

    def _show_list(self, markers: Mapping[str, tuple[str, ...]], own: tuple[str, ...]) -> None:
        places: dict[str, list[str]] = {}
        for role, labels in markers.items():
            for label in labels:
                places.setdefault(label, []).append(ROLES_BY_ID[role].words)
        for index in range(self.list.topLevelItemCount()):
            item = self.list.topLevelItem(index)
            assert item is not None
            words = places.get(item.text(0), [])
            item.setText(1, ", ".join(words) or NOT_USED_TEXT)
            colour = QColor(colours.TEXT if words else colours.TEXT_THIRD)
            for at in range(3):
                item.setForeground(at, colour)
            item.setSelected(item.text(0) in own)
        for column in (0, 2):
            self.list.resizeColumnToContents(column)
        self.list.setColumnWidth(1, 190)
