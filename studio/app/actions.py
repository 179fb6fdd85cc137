"""Table of all actions, from which menus, toolbar, command palette and the list of shortcuts are made."""

from collections.abc import Callable
from dataclasses import dataclass

from studio.app import character_import, playing_live, recovery_offer
from studio.app.live_control import (
    is_head_tracked,
    is_streaming,
    show_live,
    toggle_head_tracking,
    toggle_streaming,
)
from studio.app.marker_dialog import has_markers, open_markers
from studio.app.pose_mapping import show_map
from studio.app.relinking import relink_shown, shown_capture
from studio.app.strike_search import label_strike, show_strikes, strike_chosen
from studio.app.verbs import behaviours, cameras, clips, editing, files, media, playback, props, view
from studio.app.verbs.constraining import (
    choose_joint,
    constraint_adder,
    load_area_mesh,
    pick_skin,
    priority_shifter,
    selected_area,
    selected_constraint,
)
from studio.app.workbench import Workbench
from studio.core.constraints.base import KindInfo
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.stage.clip_row import players_of
from studio.core.stage.saved_camera import CAMERA_SLOTS
from studio.library.scenes import SCENES
from studio.viewport.eyes import Stereo

ActionFunction = Callable[[Workbench], object]
ActionTest = Callable[[Workbench], bool]

MENUS = (
    "File",
    "Scenes",
    "Edit",
    "Character",
    "Clip",
    "Constraint",
    "Prop",
    "Library",
    "Behaviour",
    "Play",
    "View",
    "Help",
)


def _always(_: Workbench) -> bool:
    return True


def _viewing(bench: Workbench) -> bool:
    return bench.has_viewport


def _performing(bench: Workbench) -> bool:
    return bench.document.active_motion_id is not None


def _ready(bench: Workbench) -> bool:
    return _performing(bench) and _viewing(bench)


def _keyed(bench: Workbench) -> bool:
    return bench.has_timeline and _performing(bench)


def _with_bodies(bench: Workbench) -> bool:
    return bool(bench.document.project.performers)


def _any_selected(bench: Workbench) -> bool:
    document = bench.document
    return bool(document.keys.items) or any(collection != "grounds" for collection, _ in document.selection.items)


def _constraint_selected(bench: Workbench) -> bool:
    return bool(bench.document.selection.of("constraints"))


def _clip_chosen(bench: Workbench) -> bool:
    return clips.chosen_clip(bench) is not None


def _copyable(bench: Workbench) -> bool:
    selection = bench.document.selection
    return _constraint_selected(bench) or bool(selection.of("clips") or selection.of("states"))


def _clip_shared(bench: Workbench) -> bool:
    return len(players_of(bench.document.project, clips.chosen_clip(bench) or "")) > 1


@dataclass(frozen=True)
class Action:
    """Command of the user: its menu, text and shortcuts, and the function that runs it. ``checked`` makes it a toggle,
    ``tool`` is its text in the toolbar, ``repeats`` lets a held key repeat it, ``ends_group`` puts a separator after it
    in the menu.
    """

    id: str
    menu: str
    text: str
    run: ActionFunction
    shortcuts: tuple[str, ...] = ()
    tooltip: str = ""
    enabled: ActionTest = _always
    checked: ActionTest | None = None
    tool: str = ""
    repeats: bool = False
    ends_group: bool = False


def _tool_is(tool: str) -> ActionTest:
    return lambda bench: _viewing(bench) and bench.viewport.tool == tool


FILE_ACTIONS = (
    Action("new", "File", "New", files.new, ("Ctrl+N",), "New project with the bundled characters"),
    Action("open", "File", "Open…", files.open_project, ("Ctrl+O",), "Open a project"),
    Action("open_sample", "File", "Open sample", files.open_sample, tooltip="The sample clip on five characters"),
    Action("recover", "File", "Recover unsaved work…", recovery_offer.choose_recovery,
           tooltip="Recover unsaved work of the last 30 days", ends_group=True),
    Action("save", "File", "Save", files.save, ("Ctrl+S",), "Save the project"),
    Action("save_as", "File", "Save as…", files.save_as, ("Ctrl+Shift+S",), "Save the project under another name"),
    Action(
        "save_increment", "File", "Save increment", files.save_increment, ("Ctrl+Alt+S",),
        "Save the next numbered version next to this file", ends_group=True,
    ),
    Action("import", "File", "Import capture…", files.import_motion, ("Ctrl+I",),
           "Import a motion (BVH, C3D, FBX and others), or drop it on the window"),
    Action("add_sound", "File", "Add sound…", media.ask_sound,
           tooltip="Add audio from a sound or video file, in sync, with its waveform and beats on the timeline"),
    Action("add_footage", "File", "Add footage…", media.ask_footage,
           tooltip="Add a video or an image sequence, in sync with the timeline"),
    Action("import_character", "File", "Import character…", files.import_character, ("Ctrl+Shift+I",),
           "Import a character, or drop it on the window"),
    Action("relink", "File", "Relink source…", relink_shown,
           tooltip="Locate the moved source file of the selected capture or of the current clip",
           enabled=lambda bench: shown_capture(bench) is not None),
    Action(
        "export", "File", "Export…", files.export, ("Ctrl+E",),
        "Export the selected or all visible characters, the source capture, or a video of the 3D view", _performing,
    ),
    Action("batch", "File", "Adapt a folder…", files.adapt_folder,
           tooltip="Adapt (retarget) every capture of a folder, in several processes", ends_group=True),
    Action("quit", "File", "Quit", files.leave, ("Ctrl+Q",), "Quit Morpho Studio"),
)  # fmt: skip

EDIT_ACTIONS = (
    Action(
        "undo", "Edit", "Undo", editing.undo, ("Ctrl+Z",), "Undo the last step",
        lambda bench: bench.document.undo_stack.canUndo(), repeats=True,
    ),
    Action(
        "redo", "Edit", "Redo", editing.redo, ("Ctrl+Shift+Z", "Ctrl+Y"), "Redo the last undone step",
        lambda bench: bench.document.undo_stack.canRedo(), repeats=True, ends_group=True,
    ),
    Action("delete", "Edit", "Delete", editing.delete, ("Del", "Backspace"), "Delete the selection", _any_selected),
    Action("copy", "Edit", "Copy", editing.copy, ("Ctrl+C",),
           "Copy the selected keys, constraints and contacts; they can be pasted into any project", _any_selected),
    Action("paste", "Edit", "Paste", editing.paste_copied, ("Ctrl+V",),
           "Paste keys at the playhead, or constraints and contacts onto the selected clip or character"),
    Action("paste_mirrored", "Edit", "Paste mirrored", editing.paste_mirrored, ("Ctrl+Shift+V",),
           "Paste with left and right swapped", ends_group=True),
    Action("set_key", "Edit", "Set key", editing.set_key, ("S",), "Key the selection at the playhead", _any_selected),
    Action("preferences", "Edit", "Preferences…", editing.preferences, ("Ctrl+,",),
           "Snapping steps, onion skins, activation, autosave, theme, scale, and shortcuts"),
    Action("escape", "Edit", "Deselect", editing.escape, ("Esc",), "Cancel the drag, or clear the selection"),
    Action(
        "report", "Edit", "Show import report", editing.select_capture,
        tooltip="Show what the source file of this clip contains and what was assumed", enabled=_performing,
    ),
    Action(
        "markers", "Edit", "Markers…", open_markers,
        tooltip="Map and clean the markers of an optical capture, and plot signals", enabled=has_markers,
    ),
    Action("ground", "Edit", "Edit ground", editing.select_ground, tooltip="Select the ground and show its settings"),
)  # fmt: skip

CHARACTER_ACTIONS = (
    Action("hide", "Character", "Toggle visibility", editing.hide, ("H",), "Show or hide the selected characters",
           _with_bodies),
    Action("solo", "Character", "Solo", editing.solo, ("Ctrl+H",),
           "Show only the selected characters; press again to show all", _with_bodies),
    Action("make_character", "Character", "Create character from actor", character_import.make_active_actor_character,
           tooltip="Create a character with the proportions of the captured actor", enabled=_performing),
    Action("line_up", "Character", "Arrange side by side", editing.line_up,
           tooltip="Place the selected characters side by side, across the direction of travel", enabled=_with_bodies),
    Action("show_all", "Character", "Show all", editing.show_all, ("Shift+H",), "Show every character", _with_bodies),
)  # fmt: skip

CLIP_ACTIONS = (
    Action("add_clip", "Clip", "Add clip…", clips.add,
           tooltip="Append a capture as a clip to the selected (or all visible) characters",
           enabled=_performing, ends_group=True),
    Action("add_layer", "Clip", "Add layer…", clips.add_layer,
           tooltip="Add a capture as a layer on the upper body or another region of the selected characters",
           enabled=_performing),
    Action("split_clip", "Clip", "Split clip at playhead", clips.split, ("Ctrl+B",),
           "Split the clip at the playhead", _clip_chosen),
    Action("mirror_clip", "Clip", "Mirror clip", clips.toggle_mirrored, ("Ctrl+M",), "Swap left and right",
           _clip_chosen),
    Action("duplicate_clip", "Clip", "Duplicate clip", clips.duplicate, tooltip="Append a copy of the clip",
           enabled=_clip_chosen),
    Action("own_clip", "Clip", "Make clip unique", clips.make_own,
           tooltip="Give this character its own copy of a shared clip", enabled=_clip_shared),
)  # fmt: skip


def _adding(kind: str, shown: KindInfo) -> Action:
    """Action that adds a constraint of a kind; for position constraints it has the shortcut C."""
    name, keys = ("add_constraint", ("C",)) if kind == "position" else (f"add_{kind}", ())
    return Action(name, "Constraint", shown.action, constraint_adder(kind), keys, shown.hint, _ready)


CONSTRAINT_ACTIONS = (
    Action("choose_joint", "Constraint", "Pick joint…", choose_joint, ("Shift+J",),
           "Pick a joint of the active character from a searchable list", _ready),
    Action("pick_skin", "Constraint", "Pick point on skin", pick_skin, ("Ctrl+Shift+J",),
           "Pick any point of a character's skin with the next click, to constrain it", _ready, ends_group=True),
    *(_adding(kind, each.value.shown) for kind, each in CONSTRAINT_KINDS.items() if each.make),
    Action("area_mesh", "Constraint", "Load mesh for volume…", load_area_mesh,
           tooltip="Load a mesh (OBJ, STL, PLY) as the shape of the selected volume constraint",
           enabled=lambda bench: selected_area(bench) is not None, ends_group=True),
    Action("raise_priority", "Constraint", "Raise priority", priority_shifter(-1), ("Alt+Up",),
           "Raise the priority of the selected constraints",
           lambda bench: selected_constraint(bench) is not None),
    Action("lower_priority", "Constraint", "Lower priority", priority_shifter(1), ("Alt+Down",),
           "Lower the priority of the selected constraints",
           lambda bench: selected_constraint(bench) is not None, ends_group=True),
    Action("duplicate", "Constraint", "Duplicate", editing.duplicate, ("Ctrl+D",),
           "Duplicate the selected constraints, the clip, or the states of a behaviour", _copyable),
)  # fmt: skip

PROP_ACTIONS = (
    Action("add_box", "Prop", "Add box", props.add_box,
           tooltip="Add a box in front of the character; constraint targets can follow it", enabled=_viewing),
    Action("add_prop", "Prop", "Add prop…", props.choose,
           tooltip="A box, ball, stick, table, stairs or a mesh file in front of the character", enabled=_viewing),
    Action("hold_prop", "Prop", "Carry prop in hands", props.hold,
           tooltip="The active character carries the selected prop with both hands",
           enabled=lambda bench: _performing(bench) and props.selected_prop(bench) is not None),
    Action("pick_up_prop", "Prop", "Pick up prop at playhead", props.pick_up,
           tooltip="The active character carries the selected prop from the playhead on",
           enabled=lambda bench: _performing(bench) and props.selected_prop(bench) is not None),
    Action("put_down_prop", "Prop", "Put down prop at playhead", props.put_down,
           tooltip="Release the selected prop at the playhead", enabled=props.is_held),
)  # fmt: skip

LIBRARY_ACTIONS = (
    Action("find_strike", "Library", "Find strike…", show_strikes, ("Ctrl+F",),
           "Search the motion library for the strike that best hits a target", _performing),
    Action("label_strike", "Library", "Classify strike…", label_strike,
           tooltip="Confirm or correct the trim range, hit frame, limb and type of the selected strike",
           enabled=strike_chosen),
    Action("pose_map", "Library", "Pose map", show_map,
           tooltip="Map of the poses in the motion library; click one to list its clips"),
)  # fmt: skip

BEHAVIOUR_ACTIONS = (
    Action("behaviour", "Behaviour", "Edit behaviour", behaviours.show_behaviour, ("Shift+B",),
           "Edit the state machine that drives the active character during live play", ends_group=True),
    *(
        Action(key, "Behaviour", text, run, tooltip=tip, enabled=_with_bodies)
        for key, (text, tip, run) in behaviours.READY_MADE_PARTS.items()
    ),
)  # fmt: skip

PLAY_ACTIONS = (
    Action("play", "Play", "Play or pause", playback.toggle, ("Space",)),
    Action("play_live", "Play", "Play live", playing_live.toggle, ("Shift+Space",),
           "Live play: press 1 to 9 to start clips; everything can be edited meanwhile",
           _ready, lambda bench: bench.live.play.running),
    Action("record_take", "Play", "Record take", playing_live.record, ("Shift+R",),
           "Record the live session as clips and keyed targets", lambda bench: bench.live.play.running,
           lambda bench: bench.live.play.recording, ends_group=True),
    Action("next_frame", "Play", "Next frame", playback.next_frame, ("Right",), repeats=True),
    Action("previous_frame", "Play", "Previous frame", playback.previous_frame, ("Left",), repeats=True),
    Action("first_frame", "Play", "Go to start", playback.first_frame, ("Shift+Left", "Home")),
    Action("last_frame", "Play", "Go to end", playback.last_frame, ("Shift+Right", "End")),
    Action("next_event", "Play", "Next contact or key", playback.next_event, ("Down", "."), repeats=True,
           enabled=_keyed),
    Action("previous_event", "Play", "Previous contact or key", playback.previous_event, ("Up", ","), repeats=True,
           enabled=_keyed, ends_group=True),
    Action("next_problem", "Play", "Next problem", playback.next_problem, ("N",),
           "Go to the worst error, foot sliding, penetration or pop, then to the next", _ready, repeats=True),
    Action("previous_problem", "Play", "Previous problem", playback.previous_problem, ("Shift+N",), enabled=_ready,
           repeats=True, ends_group=True),
    Action("add_label", "Play", "Add label", playback.add_label, ("M",),
           "Add a label at the playhead; double-click it to rename", _keyed),
    Action("next_label", "Play", "Next label", playback.next_label, ("Shift+Down",), repeats=True, enabled=_keyed),
    Action("previous_label", "Play", "Previous label", playback.previous_label, ("Shift+Up",), repeats=True,
           enabled=_keyed, ends_group=True),
    Action("range_from_here", "Play", "Set range start", playback.range_from_here, ("I",)),
    Action("range_to_here", "Play", "Set range end", playback.range_to_here, ("O",)),
    Action("whole_range", "Play", "Reset range", playback.whole_range, ("Shift+O",), enabled=_performing,
           ends_group=True),
    Action("shuttle_back", "Play", "Play backwards", playback.shuttle_back, ("J",), "Press again to double the speed"),
    Action("stop", "Play", "Stop", playback.stop, ("K",)),
    Action("shuttle_on", "Play", "Play forwards", playback.shuttle_forward, ("L",), "Press again to double the speed"),
    Action("loop", "Play", "Loop", playback.toggle_loop, ("Ctrl+L",), "Loop playback over the range",
           checked=lambda bench: bench.document.playhead.loop),
    Action("mute", "Play", "Mute sounds", media.toggle_muted, tooltip="Mute all sounds; they stay on the timeline",
           enabled=lambda bench: bool(bench.document.project.sounds),
           checked=lambda bench: bench.window.sound_playback.muted),
)  # fmt: skip

LIVE_ACTIONS = (
    Action("live_panel", "Play", "Live input and output…", show_live, ("Ctrl+Shift+L",),
           "VMC input, the characters and props that it drives, and VMC output"),
    Action("stream", "Play", "Stream characters as VMC", toggle_streaming,
           tooltip="Stream to the address set in the Live panel",
           checked=is_streaming, ends_group=True),
)  # fmt: skip

VIEW_ACTIONS = (
    Action("select_tool", "View", "Select tool", view.select_tool, ("Q",), "Click to select", _viewing,
           _tool_is("select"), tool="select"),
    Action("move_tool", "View", "Move tool", view.move_tool, ("W",), "Drag targets by their arrows", _viewing,
           _tool_is("move"), tool="move"),
    Action("rotate_tool", "View", "Rotate tool", view.rotate_tool, ("E",),
           "Rotate targets, volumes, props and characters by rings", _viewing, _tool_is("rotate"), tool="rotate"),
    Action("scale_tool", "View", "Scale tool", view.scale_tool, ("R",), "Resize volumes and props", _viewing,
           _tool_is("scale"), tool="scale"),
    Action("correct_pose", "View", "Pose correction", view.toggle_correcting, ("P",),
           "Pose on a correction layer over the clip: rotate joints, move hands, feet, hips and head", _ready,
           lambda bench: _viewing(bench) and bench.viewport.correcting),
    Action("gizmo_axes", "View", "Cycle gizmo orientation", view.next_gizmo_axes, ("T",),
           "Gizmo orientation: world, local, parent or screen", _viewing,
           ends_group=True),
    Action("frame_selection", "View", "Frame selection", view.frame_selection, ("F",), enabled=_viewing),
    Action("frame_all", "View", "Frame all", view.frame_all, ("A",), enabled=_viewing),
    Action("front", "View", "Front", view.front, ("1",), enabled=_viewing),
    Action("side", "View", "Side", view.side, ("3",), enabled=_viewing),
    Action("top", "View", "Top", view.top, ("7",), enabled=_viewing),
    Action("perspective", "View", "Three-quarter", view.perspective, ("0",), "From ahead, aside and above", _viewing,
           ends_group=True),
    *(
        Action(f"camera_{slot}", "View", f"Look through camera {slot}", cameras.slot_recaller(slot), (f"F{slot + 4}",),
               "Look through the camera in this slot", _viewing)
        for slot in CAMERA_SLOTS
    ),
    *(
        Action(f"store_camera_{slot}", "View", f"Store camera {slot}", cameras.slot_storer(slot),
               (f"Shift+F{slot + 4}", f"Ctrl+F{slot + 4}"), "Store the current view in this slot", _viewing)
        for slot in CAMERA_SLOTS
    ),
    Action("add_camera", "View", "Add camera", cameras.add, (), "Save the current view as a new, named camera",
           _viewing),
    Action("cameras", "View", "Cameras…", cameras.choose, ("Alt+C",), "Look through a saved camera, by its name",
           _viewing),
    Action("turntable", "View", "Turntable", cameras.toggle_turntable, ("Alt+T",),
           "Orbit the camera around its target; click in the view to stop", _viewing,
           lambda bench: _viewing(bench) and bench.viewport.turntable, ends_group=True),
    Action("follow", "View", "Camera follows character", view.toggle_following, ("Shift+F",),
           "Keep the camera on the selected character, or on the first one", _viewing,
           lambda bench: _viewing(bench) and bench.viewport.following),
    Action("side_by_side", "View", "Stereo: side by side", view.toggle_stereo(Stereo.SIDE_BY_SIDE),
           tooltip="One image per eye, side by side", enabled=_viewing,
           checked=lambda bench: _viewing(bench) and bench.viewport.stereo_view.stereo is Stereo.SIDE_BY_SIDE),
    Action("anaglyph", "View", "Stereo: anaglyph", view.toggle_stereo(Stereo.ANAGLYPH),
           tooltip="One image for red and cyan glasses", enabled=_viewing,
           checked=lambda bench: _viewing(bench) and bench.viewport.stereo_view.stereo is Stereo.ANAGLYPH),
    Action("head_tracked", "View", "Head-tracked camera", toggle_head_tracking,
           tooltip="Move the camera with the head tracked in the Live panel", enabled=_viewing,
           checked=is_head_tracked, ends_group=True),
    Action("ghost", "View", "Source ghost", view.toggle_ghost, ("G",),
           "Show the source capture on the actor's skeleton", _viewing,
           lambda bench: _viewing(bench) and bench.viewport.ghost_shown),
    Action("onion_skins", "View", "Onion skins", view.toggle_onion_skins, ("Alt+O",),
           "Show the selected character at frames before and after the playhead; set the number in the"
           " preferences", _viewing,
           lambda bench: _viewing(bench) and bench.viewport.onion_shown),
    Action("keep_ghost", "View", "Add pose ghost", view.keep_ghost, ("Alt+K",),
           "Leave a ghost of the selected character's pose at the playhead", _ready),
    Action("clear_ghosts", "View", "Clear pose ghosts", view.clear_ghosts, ("Alt+Shift+K",), "Remove all pose ghosts",
           lambda bench: _viewing(bench) and bool(bench.viewport.kept_ghosts)),
    Action("recorded_markers", "View", "Recorded markers", view.toggle_markers, ("Shift+G",),
           "Markers, force plates and forces of an optical capture", _viewing,
           lambda bench: _viewing(bench) and bench.viewport.markers_shown),
    Action("marker_names", "View", "Marker names", view.toggle_marker_names, (), "Show the name of every marker",
           _viewing, lambda bench: _viewing(bench) and bench.viewport.recording.named, ends_group=True),
    Action("dope_sheet", "View", "Dope sheet", view.toggle_dope_sheet, ("Shift+D",),
           "Show the keys of the selection, or all keys", _keyed,
           lambda bench: bench.has_timeline and bench.timeline.dope),
    Action("curve_editor", "View", "Curve editor", view.toggle_curve_editor, ("Shift+E",),
           "Show the animation curves of the selection, with keys and tangents", _keyed,
           lambda bench: bench.has_timeline and bench.timeline.editing_curves),
    Action("fold_rows", "View", "Collapse timeline tracks", view.fold_rows, ("Shift+T",),
           "Collapse constraint tracks and the graph to one line each", _keyed),
    Action("search_library", "View", "Search outliner", view.search_library, ("Ctrl+Shift+F",),
           "Show only the outliner items whose name or tag contains the text"),
    Action("console", "View", "Python console", view.console, ("Ctrl+Shift+P",),
           "Run Python on the open project; its changes are undo steps", ends_group=True),
    Action("problems", "View", "Problem table", view.problems,
           tooltip="All constraints by character: error, foot sliding, penetration and pops; click a column to sort"),
    Action("arrange", "View", "Unlock panels", view.arrange, tooltip="Show title bars, so that panels can be moved",
           checked=lambda bench: bench.window.arranging),
    Action("reset_layout", "View", "Reset layout", view.reset_layout, ends_group=True),
)  # fmt: skip

HELP_ACTIONS = (
    Action("guide", "Help", "Guide", view.guide, ("F1",), "Open the illustrated guide"),
    Action("tour", "Help", "Tour", view.tour, tooltip="A first edit in five steps, on the sample", enabled=_viewing),
    Action("palette", "Help", "Search actions…", view.palette, ("Ctrl+K",), "Find any action by its name"),
    Action(
        "formats",
        "Help",
        "Supported file formats",
        view.formats,
        tooltip="List the file formats that can be read and written, and those that failed to load",
    ),
    Action(
        "plug_ins",
        "Help",
        "Plug-ins",
        view.plug_ins,
        tooltip="List installed plug-ins, and those that failed to load",
    ),
    Action("shortcuts", "Help", "Shortcuts", view.shortcuts, ("?",), "List all keyboard shortcuts"),
)

SCENE_ACTIONS = tuple(
    Action(f"scene_{scene.key}", "Scenes", scene.title, files.scene_opener(scene), tooltip=scene.text)
    for scene in SCENES
)

ACTIONS: tuple[Action, ...] = (
    *FILE_ACTIONS,
    *SCENE_ACTIONS,
    *EDIT_ACTIONS,
    *CHARACTER_ACTIONS,
    *CLIP_ACTIONS,
    *CONSTRAINT_ACTIONS,
    *PROP_ACTIONS,
    *LIBRARY_ACTIONS,
    *BEHAVIOUR_ACTIONS,
    *PLAY_ACTIONS,
    *LIVE_ACTIONS,
    *VIEW_ACTIONS,
    *HELP_ACTIONS,
)
