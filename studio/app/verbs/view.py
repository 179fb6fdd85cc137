"""Actions of the view: camera, ghost, tools, panels, palette."""

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices

from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.io import plug_ins as plug_in_groups
from studio.io.registry import Format, known_formats
from studio.resources_folder import guide_file
from studio.viewport.eyes import Stereo


def frame_selection(bench: Workbench) -> None:
    """The selected thing fills the view."""
    bench.viewport.frame_selection()


def frame_all(bench: Workbench) -> None:
    """All bodies fill the view."""
    bench.viewport.frame_all()


def front(bench: Workbench) -> None:
    """From the front."""
    bench.viewport.set_view("front")


def side(bench: Workbench) -> None:
    """From the side."""
    bench.viewport.set_view("side")


def top(bench: Workbench) -> None:
    """From above."""
    bench.viewport.set_view("top")


def perspective(bench: Workbench) -> None:
    """Three-quarter, as at first."""
    bench.viewport.set_view("perspective")


def toggle_ghost(bench: Workbench) -> None:
    """The capture on its own actor's body, beside what was made of it."""
    bench.viewport.set_ghost_shown(not bench.viewport.ghost_shown)


def toggle_onion_skins(bench: Workbench) -> None:
    """The selected bodies at frames before and after the playhead, or not."""
    bench.viewport.set_onion_shown(not bench.viewport.onion_shown)


def keep_ghost(bench: Workbench) -> None:
    """The selected bodies as they are at the playhead stay in sight."""
    bench.viewport.keep_ghosts()


def clear_ghosts(bench: Workbench) -> None:
    """No kept moment is seen any more."""
    bench.viewport.clear_ghosts()


def toggle_following(bench: Workbench) -> None:
    """The camera goes with the selected character."""
    bench.viewport.set_following(not bench.viewport.following)


def toggle_stereo(stereo: Stereo) -> Callable[[Workbench], None]:
    """Two eyes' pictures in that way, or one again."""

    def toggle(bench: Workbench) -> None:
        now = bench.viewport.sight
        bench.viewport.set_sight(replace(now, stereo=Stereo.OFF if now.stereo is stereo else stereo))

    return toggle


def toggle_markers(bench: Workbench) -> None:
    """Markers, plates and forces of an optical capture, as they were recorded."""
    bench.viewport.set_markers_shown(not bench.viewport.markers_shown)


def toggle_marker_names(bench: Workbench) -> None:
    """Every marker with its name."""
    bench.viewport.recording.name(not bench.viewport.recording.named)


def toggle_dope_sheet(bench: Workbench) -> None:
    """Show the timeline as a dope sheet, or as it was."""
    bench.timeline.set_dope(not bench.timeline.dope)


def toggle_curve_editor(bench: Workbench) -> None:
    """Make the timeline's plot the curve editor, or as it was."""
    bench.timeline.edit_curves(not bench.timeline.editing_curves)


def fold_rows(bench: Workbench) -> None:
    """Constraints and plot on the timeline a line high each, or as high as they were."""
    bench.timeline.fold_rows()


def select_tool(bench: Workbench) -> None:
    """Click to select."""
    _take_tool(bench, "select")


def move_tool(bench: Workbench) -> None:
    """Drag targets and props by the gizmo."""
    _take_tool(bench, "move")


def rotate_tool(bench: Workbench) -> None:
    """Rotate targets, areas, props and bodies by the gizmo."""
    _take_tool(bench, "rotate")


def scale_tool(bench: Workbench) -> None:
    """Resize areas and props by the gizmo."""
    _take_tool(bench, "scale")


def toggle_correcting(bench: Workbench) -> None:
    """Pose joints by the gizmo, as corrections, or move and turn what is selected."""
    bench.viewport.set_correcting(not bench.viewport.correcting)


def next_gizmo_axes(bench: Workbench) -> None:
    """Move and rotate along the axes of the next space."""
    bench.viewport.next_gizmo_space()


def palette(bench: Workbench) -> None:
    """Find an action by its name."""
    bench.window.palette_panel.open()


def search_library(bench: Workbench) -> None:
    """Write words that names in the library must hold."""
    bench.window.search_library()


def console(bench: Workbench) -> None:
    """The Python console on the open project."""
    bench.window.show_console()


def shortcuts(bench: Workbench) -> None:
    """All shortcuts on one sheet."""
    bench.window.show_shortcuts()


def guide(bench: Workbench) -> None:
    """Open the guide in the system's own reader. Raises StudioError where there is none."""
    if not QDesktopServices.openUrl(QUrl.fromLocalFile(str(guide_file()))):
        raise StudioError(f"No program opens {guide_file()}. It is a Markdown file: open it with any text editor.")


def formats(bench: Workbench) -> None:
    """The kinds of files that are known, what can be done with each, and those that could not be added."""
    known = known_formats()
    rows = [(f"{each.name}  {' '.join(each.suffixes)}", _uses(each)) for each in known.formats]
    rows += [(sentence, "failed") for sentence in known.failures]
    bench.window.choose("Supported file formats", [(row, lambda: None) for row in rows])


def plug_ins(bench: Workbench) -> None:
    """Show what installed packages add, with the error of what cannot be loaded."""
    groups = {
        plug_in_groups.VERBS_GROUP: plug_in_groups.verb_of,
        plug_in_groups.PANELS_GROUP: plug_in_groups.panel_of,
        plug_in_groups.FORMATS_GROUP: lambda found: found,
        plug_in_groups.CONSTRAINTS_GROUP: plug_in_groups.kind_of,
        plug_in_groups.MEASURES_GROUP: plug_in_groups.measure_of_plug_in,
    }
    rows: list[tuple[str, str]] = []
    for group, accepted in groups.items():
        for offer in plug_in_groups.offers(group):
            try:
                offer.load(accepted)
                rows.append((f"{offer.name}  {offer.words}", offer.package))
            except StudioError as error:
                rows.append((str(error), "failed"))
    none = [("No installed package adds anything. docs/scripts.md tells how one does.", "")]
    bench.window.choose("Plug-ins", [(row, lambda: None) for row in rows or none])


def _uses(known: Format) -> str:
    uses = (f"reads {', '.join(known.reads)}" if known.reads else "", "writes" if known.writes else "")
    return "; ".join(use for use in uses if use)


def tour(bench: Workbench) -> None:
    """A first edit in five steps."""
    bench.window.tour.begin()


def problems(bench: Workbench) -> None:
    """The table of constraints by body."""
    bench.window.show_dock("Problems")


def arrange(bench: Workbench) -> None:
    """Give the panels title bars by which they can be moved, or take them away."""
    bench.window.arrange(not bench.window.arranging)


def reset_layout(bench: Workbench) -> None:
    """All panels where they were in the beginning."""
    bench.window.reset_layout()


def _take_tool(bench: Workbench, tool: str) -> None:
    bench.viewport.set_tool(tool)
    bench.views_changed.emit()
