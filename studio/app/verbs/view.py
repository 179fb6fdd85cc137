"""Actions of the View menu: camera, ghosts, tools and panels."""

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
    """Move the camera so that the selection fills the view."""
    bench.viewport.frame_selection()


def frame_all(bench: Workbench) -> None:
    """Move the camera so that all characters are in view."""
    bench.viewport.frame_all()


def front(bench: Workbench) -> None:
    """Show the front view."""
    bench.viewport.set_view("front")


def side(bench: Workbench) -> None:
    """Show the side view."""
    bench.viewport.set_view("side")


def top(bench: Workbench) -> None:
    """Show the top view."""
    bench.viewport.set_view("top")


def perspective(bench: Workbench) -> None:
    """Show the default three-quarter view."""
    bench.viewport.set_view("perspective")


def toggle_ghost(bench: Workbench) -> None:
    """Show or hide the source motion on the actor's own body beside the active character."""
    bench.viewport.set_ghost_shown(not bench.viewport.ghost_shown)


def toggle_onion_skins(bench: Workbench) -> None:
    """Show or hide onion skins of the selected characters."""
    bench.viewport.set_onion_shown(not bench.viewport.onion_shown)


def keep_ghost(bench: Workbench) -> None:
    """Add a ghost of the selected characters at the playhead."""
    bench.viewport.keep_ghosts()


def clear_ghosts(bench: Workbench) -> None:
    """Remove all added ghosts."""
    bench.viewport.clear_ghosts()


def toggle_following(bench: Workbench) -> None:
    """Toggle if the camera follows the selected character."""
    bench.viewport.set_following(not bench.viewport.following)


def toggle_stereo(stereo: Stereo) -> Callable[[Workbench], None]:
    """Function of the action that toggles a stereo mode."""

    def toggle(bench: Workbench) -> None:
        now = bench.viewport.stereo_view
        bench.viewport.set_stereo_view(replace(now, stereo=Stereo.OFF if now.stereo is stereo else stereo))

    return toggle


def toggle_markers(bench: Workbench) -> None:
    """Show or hide the recorded markers, force plates and forces of an optical capture."""
    bench.viewport.set_markers_shown(not bench.viewport.markers_shown)


def toggle_marker_names(bench: Workbench) -> None:
    """Show or hide the labels of all markers."""
    bench.viewport.recording.set_named(not bench.viewport.recording.named)


def toggle_dope_sheet(bench: Workbench) -> None:
    """Switch the timeline to the dope sheet, or back."""
    bench.timeline.set_dope(not bench.timeline.dope)


def toggle_curve_editor(bench: Workbench) -> None:
    """Switch the timeline's graph to the curve editor, or back."""
    bench.timeline.edit_curves(not bench.timeline.editing_curves)


def fold_rows(bench: Workbench) -> None:
    """Collapse constraint tracks and the graph of the timeline to one line each, or expand them."""
    bench.timeline.fold_rows()


def select_tool(bench: Workbench) -> None:
    """Activate the selection tool."""
    _take_tool(bench, "select")


def move_tool(bench: Workbench) -> None:
    """Activate the move gizmo for targets and props."""
    _take_tool(bench, "move")


def rotate_tool(bench: Workbench) -> None:
    """Activate the rotate gizmo for targets, volumes, props and characters."""
    _take_tool(bench, "rotate")


def scale_tool(bench: Workbench) -> None:
    """Activate the scale gizmo for volumes and props."""
    _take_tool(bench, "scale")


def toggle_correcting(bench: Workbench) -> None:
    """Toggle pose correction, in which the gizmo poses joints on a correction layer instead of moving the selection."""
    bench.viewport.set_correcting(not bench.viewport.correcting)


def next_gizmo_axes(bench: Workbench) -> None:
    """Switch the gizmo to the next orientation: world, local, parent, screen."""
    bench.viewport.next_gizmo_space()


def palette(bench: Workbench) -> None:
    """Show the command palette."""
    bench.window.palette_panel.open()


def search_library(bench: Workbench) -> None:
    """Focus the search field of the library."""
    bench.window.search_library()


def console(bench: Workbench) -> None:
    """Show the Python console of the open project."""
    bench.window.show_console()


def shortcuts(bench: Workbench) -> None:
    """Show the list of all shortcuts."""
    bench.window.show_shortcuts()


def guide(bench: Workbench) -> None:
    """Open the guide in the system's viewer. Raises StudioError if there is none."""
    if not QDesktopServices.openUrl(QUrl.fromLocalFile(str(guide_file()))):
        raise StudioError(f"No program opens {guide_file()}. It is a Markdown file: open it with any text editor.")


def formats(bench: Workbench) -> None:
    """List the known file formats, if they can be read or written, and those that failed to load."""
    known = known_formats()
    rows = [(f"{each.name}  {' '.join(each.suffixes)}", _uses(each)) for each in known.formats]
    rows += [(sentence, "failed") for sentence in known.failures]
    bench.window.choose("Supported file formats", [(row, lambda: None) for row in rows])


def plug_ins(bench: Workbench) -> None:
    """List the plug-ins of installed packages, and the errors of those that failed to load."""
    groups = {
        plug_in_groups.VERBS_GROUP: plug_in_groups.verb_of,
        plug_in_groups.PANELS_GROUP: plug_in_groups.panel_of,
        plug_in_groups.FORMATS_GROUP: lambda found: found,
        plug_in_groups.CONSTRAINTS_GROUP: plug_in_groups.kind_of,
        plug_in_groups.MEASURES_GROUP: plug_in_groups.measure_of_plug_in,
    }
    rows: list[tuple[str, str]] = []
    for group, accepted in groups.items():
        for offer in plug_in_groups.plug_in_entries(group):
            try:
                offer.load(accepted)
                rows.append((f"{offer.name}  {offer.words}", offer.package))
            except StudioError as error:
                rows.append((str(error), "failed"))
    none = [("No plug-ins are installed. See docs/scripts.md.", "")]
    bench.window.choose("Plug-ins", [(row, lambda: None) for row in rows or none])


def _uses(known: Format) -> str:
    uses = (f"reads {', '.join(known.reads)}" if known.reads else "", "writes" if known.writes else "")
    return "; ".join(use for use in uses if use)


def tour(bench: Workbench) -> None:
    """Start the guided tour: a first edit in five steps."""
    bench.window.tour.begin()


def problems(bench: Workbench) -> None:
    """Show the problem table."""
    bench.window.show_dock("Problems")


def arrange(bench: Workbench) -> None:
    """Show or hide the title bars by which panels are moved."""
    bench.window.set_dock_titles_shown(not bench.window.arranging)


def reset_layout(bench: Workbench) -> None:
    """Move all panels to their default places."""
    bench.window.reset_layout()


def _take_tool(bench: Workbench, tool: str) -> None:
    bench.viewport.set_tool(tool)
    bench.views_changed.emit()
