"""Panels of installed plug-ins, loaded when they are first shown."""

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDockWidget, QWidget

from studio.core.errors import StudioError
from studio.document.mnemonics import escaped_mnemonics
from studio.io import plug_ins

if TYPE_CHECKING:
    from studio.app.main_window import MainWindow


def add_panel_actions(window: "MainWindow") -> None:
    """Add an entry to the *View* menu for each panel of a plug-in, without loading the panel."""
    for offer in plug_ins.plug_in_entries(plug_ins.PANELS_GROUP):
        action = QAction(escaped_mnemonics(f"{offer.name.replace('_', ' ').capitalize()} panel"), window)
        action.setToolTip(f"Added by {offer.package}")
        action.triggered.connect(lambda _=False, offer=offer: show_plug_in(window, offer))
        window.actions_by_id.menus["View"].addAction(action)


def show_plug_in(window: "MainWindow", offer: plug_ins.PlugInEntry) -> None:
    """Show the panel of a plug-in beside the inspector; an error in it is reported as a message."""
    key = f"plug-in {offer.name}"
    if key not in window.docks:
        try:
            dock = _dock(window, offer)
        except StudioError as error:
            window.bench.post_message(str(error))
            return
        dock.setObjectName(key)
        window.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, dock)
        window.tabifyDockWidget(window.docks["Inspector"], dock)
        window.docks[key] = dock
        window.set_dock_titles_shown(window.arranging)
    window.show_dock(key)


def _dock(window: "MainWindow", offer: plug_ins.PlugInEntry) -> QDockWidget:
    from studio import api  # late: it loads what renders and searches

    panel = offer.load(plug_ins.panel_of)
    try:
        widget = panel.make(api.Scene(window.bench.document))
    except Exception as error:  # another's code may raise anything
        raise StudioError(f"The panel '{offer.name}' of {offer.package} could not be created: {error}") from error
    if not isinstance(widget, QWidget):
        raise StudioError(f"The panel '{offer.name}' of {offer.package} is a {type(widget).__name__}, not a QWidget.")
    dock = QDockWidget(panel.title, window)
    dock.setWidget(widget)
    return dock
