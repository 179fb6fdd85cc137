"""Export dialog of the window: content, file format, and options."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QVBoxLayout

from studio.app import exporting, filming
from studio.app.file_dialogs import ask_folder, ask_new_file
from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.core.names import safe_name
from studio.io.export_choices import REST_POSE_SUFFIXES, REST_POSES, ROOT_CHOICES, SKELETON_SUFFIXES
from studio.io.export_options import ExportOptions
from studio.io.joint_names import joint_namings
from studio.io.registry import known_formats
from studio.io.staged_export import file_name, other_joints
from studio.panels.fields import Choice, Section

EXPORT_DIALOG_WIDTH = 420


class ExportContent(Enum):
    """Content that can be exported."""

    ADAPTED = "Adapted motion"
    STAGE = "Whole stage"
    MOTION = "Source capture"
    FILM = "Video of the 3D view"


@dataclass(frozen=True)
class ExportKind:
    """File format in which one kind of content can be exported."""

    what: ExportContent
    suffix: str
    text: str


IMAGE_SIZES = ((1280, 720), (1920, 1080), (2560, 1440), (3840, 2160), (1080, 1080), (1080, 1920))
FRAME_RATES = (24.0, 25.0, 30.0, 60.0)
MOTION_FRAME_RATES = (*FRAME_RATES, 120.0)
CONTENTS_WITH_BODIES = (ExportContent.ADAPTED, ExportContent.STAGE)
"""Contents with skeletons, to which the options for joints and rest pose apply."""
ORIGINAL_NAMES_LABEL = "Original names"
FORMAT_HINTS = {
    ".bvh": "Skeleton and rotations; supported by nearly every program.",
    ".fbx": "Joints, skin, materials and animation for Maya, MotionBuilder, Unreal, Unity and Blender.",
    ".s4d": "The motion as it was captured, with its contacts and constraints, for any character.",
    ".glb": "Joints, skin, materials and animation in one file.",
    ".gltf": "The same as GLB, as text.",
    ".vrma": "Animation for any VRM avatar; without skin.",
    ".usd": "Joints, skin and animation for USD pipelines; textures as images beside it.",
    ".usdz": "The same with its textures in one file.",
    ".c3d": "Joint centres and virtual markers, for biomechanics software.",
    ".csv": "World position of every joint per frame, and the constraint errors.",
    ".npz": "The same as CSV, for NumPy.",
    ".mp4": "The play range, as shown in the 3D view.",
    "": "One PNG image per frame of the 3D view, in a new folder.",
}


def kinds() -> tuple[ExportKind, ...]:
    """Every combination of content and file format that can be exported."""
    motions = [
        ExportKind(ExportContent.ADAPTED, suffix, f"{each.name} ({suffix})")
        for each in known_formats().that_can("motion_writer")
        for suffix in each.suffixes
        if suffix not in (".usda", ".usdc")  # .usd is either
    ]
    stages = [
        ExportKind(ExportContent.STAGE, suffix, f"{each.name} ({suffix})")
        for each in known_formats().that_can("stage_writer")
        for suffix in each.suffixes
        if suffix not in (".usda", ".usdc")
    ]
    return (
        *motions,
        *stages,
        ExportKind(ExportContent.MOTION, ".s4d", "S4D (.s4d)"),
        ExportKind(ExportContent.FILM, ".mp4", "Video (.mp4)"),
        ExportKind(ExportContent.FILM, "", "Image sequence (.png)"),
    )


class ExportDialog(QDialog):
    """Dialog for content, format and options; then the system's file dialog asks for the path."""

    def __init__(self, bench: Workbench) -> None:
        super().__init__(bench.window)
        self._bench, self._kinds = bench, kinds()
        self.setObjectName("export_dialog")
        self.setWindowTitle("Export")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.what = Choice("Content", [(what, self._said(what)) for what in self._offered()])
        self.kind = Choice("Format", ())
        self.names = Choice(
            "Joint naming", [("", ORIGINAL_NAMES_LABEL), *((key, each.name) for key, each in joint_namings().items())]
        )
        self.rest = Choice("Rest pose", list(REST_POSES.items()))
        self._carried = self._carriable()
        first, more = self._carried[:1], len(self._carried) - 1
        words = f"Keep: {', '.join(first)}{f' and {more} more' if more > 0 else ''}"
        self.others = Choice("Other joints", [("carry", words), ("leave", "Leave out")])
        self.range = Choice("Range", [("all", "All frames"), ("timeline", "Play range")])
        self.frame_rate = Choice(
            "Frame rate", [(None, "As captured"), *((rate, f"{rate:g} fps") for rate in MOTION_FRAME_RATES)]
        )
        self.root = Choice("Root", list(ROOT_CHOICES.items()))
        self.position = Choice("Position", [("stage", "On the stage"), ("origin", "At the origin")])
        self.picture_size = Choice("Size", [(size, f"{size[0]} × {size[1]}") for size in IMAGE_SIZES])
        self.rate = Choice("Frame rate", [(rate, f"{rate:g} fps") for rate in FRAME_RATES])
        self.hint = QLabel()
        self.hint.setProperty("role", "hint")
        self.hint.setWordWrap(True)
        self._rows = Section("Export")
        self._labels = {
            choice: self._rows.add_row(choice.accessibleName(), choice)
            for choice in (
                *(self.what, self.kind, self.range, self.frame_rate, self.names, self.rest, self.root, self.position),
                *(self.others, self.picture_size, self.rate),
            )
        }
        self._rows.add_wide(self.hint)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.go = buttons.addButton("Export…", QDialogButtonBox.ButtonRole.AcceptRole)
        buttons.accepted.connect(self._ask_where)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 0, 12, 12)
        column.setSpacing(16)
        column.setSizeConstraint(QVBoxLayout.SizeConstraint.SetFixedSize)  # as tall as the options of the format
        column.addWidget(self._rows)
        column.addWidget(buttons)
        self._rows.setMinimumWidth(EXPORT_DIALOG_WIDTH)
        self.what.value_chosen.connect(self._show_kinds)
        self.kind.value_chosen.connect(self._show_options)
        self._show_kinds(self.what.value)
        self._show_last(bench.settings.exported)

    def choose(self, what: ExportContent, suffix: str) -> None:
        """Choose content and suffix, as the user would."""
        self.what.show_value(what)
        self._show_kinds(what)
        self.kind.show_value(next(each for each in self._kinds if (each.what, each.suffix) == (what, suffix)))
        self._show_options(self.kind.value)

    @property
    def options(self) -> ExportOptions:
        """Export options chosen for the current format."""
        chosen = self.kind.value
        assert isinstance(chosen, ExportKind)
        if chosen.what not in CONTENTS_WITH_BODIES:
            return ExportOptions()
        playhead, rate = self._bench.document.playhead, self.frame_rate.value
        begin, end = playhead.first / playhead.frame_rate, playhead.last / playhead.frame_rate
        is_cut = self.range.value == "timeline"
        return ExportOptions(
            joint_names=str(self.names.value),
            rest_pose=str(self.rest.value) if chosen.suffix in REST_POSE_SUFFIXES else "",
            body_only=self.others.value == "leave",
            begin=begin if is_cut else None,
            end=end if is_cut else None,
            frame_rate=rate if isinstance(rate, float) else None,
            root=str(self.root.value) if chosen.suffix != ".s4d" else "",
            at_origin=chosen.what is ExportContent.ADAPTED and self.position.value == "origin",
        )

    def _said(self, what: ExportContent) -> str:
        """Label of a content, with the name or number of the characters to be exported."""
        if what is not ExportContent.ADAPTED:
            return str(what.value)
        keys = exporting.chosen_performers(self._bench)
        performers = self._bench.document.project.performers
        return f"{what.value} of {performers[keys[0]].name if len(keys) == 1 else f'{len(keys)} characters'}"

    def _show_last(self, last: Mapping[str, object]) -> None:
        """Restore the choices of the last export, as far as they are still available."""
        for what, suffix in ((each.what, each.suffix) for each in self._kinds):
            if self.what.offers(what) and [what.name, suffix] == last.get("kind"):
                self.choose(what, suffix)
        size = last.get("size")
        usual = {
            self.range: "all",
            self.frame_rate: None,
            self.root: "",
            self.position: "stage",
            self.names: "",
            self.rest: "t",
            self.others: "carry",
            self.picture_size: IMAGE_SIZES[0],
            self.rate: 30.0,
        }
        for choice, value in (
            (self.range, last.get("range")),
            (self.frame_rate, last.get("frame_rate")),
            (self.root, last.get("root")),
            (self.position, last.get("position")),
            (self.names, last.get("names")),
            (self.rest, last.get("rest")),
            (self.others, last.get("others")),
            (self.picture_size, tuple(size) if isinstance(size, list) else None),
            (self.rate, last.get("rate")),
        ):
            choice.show_value(value if choice.offers(value) else usual[choice])

    def _remember(self, kind: ExportKind) -> None:
        self._bench.settings.exported = {
            "kind": [kind.what.name, kind.suffix],
            "range": self.range.value,
            "frame_rate": self.frame_rate.value,
            "root": self.root.value,
            "position": self.position.value,
            "names": self.names.value,
            "rest": self.rest.value,
            "others": self.others.value,
            "size": self.picture_size.value,
            "rate": self.rate.value,
        }

    def _offered(self) -> list[ExportContent]:
        """Contents that can be exported from the current project."""
        performing = exporting.chosen_performers(self._bench)
        motion = self._bench.document.active_motion_id
        there = {
            ExportContent.ADAPTED: bool(performing),
            ExportContent.STAGE: bool(performing),
            ExportContent.MOTION: motion is not None,
            ExportContent.FILM: bool(performing) and self._bench.has_viewport,
        }
        return [what for what in ExportContent if there[what]]

    def _carriable(self) -> tuple[str, ...]:
        """Names of joints that are not part of the body map, from the capture that has most of them."""
        project = self._bench.document.project
        clips = [project.performers[key].clips[0] for key in exporting.chosen_performers(self._bench)]
        captures = [project.captures[project.motions[clip.motion_id].capture_id] for clip in clips]
        return max((other_joints(capture) for capture in captures), key=len, default=())

    def _show_kinds(self, what: object) -> None:
        self.kind.clear_all()
        for each in self._kinds:
            if each.what is what:
                self.kind.add(each, each.text)
        self._show_options(self.kind.value)

    def _show_options(self, kind: object) -> None:
        assert isinstance(kind, ExportKind)
        shown = {
            self.range: kind.what in CONTENTS_WITH_BODIES,
            self.frame_rate: kind.what in CONTENTS_WITH_BODIES,
            self.names: kind.what in CONTENTS_WITH_BODIES,
            self.rest: kind.what in CONTENTS_WITH_BODIES and kind.suffix in REST_POSE_SUFFIXES,
            self.root: kind.what in CONTENTS_WITH_BODIES and kind.suffix != ".s4d",
            self.position: kind.what is ExportContent.ADAPTED,
            self.others: kind.what in CONTENTS_WITH_BODIES and kind.suffix in SKELETON_SUFFIXES and bool(self._carried),
            self.picture_size: kind.what is ExportContent.FILM,
            self.rate: kind.what is ExportContent.FILM,
        }
        for choice, is_shown in shown.items():
            choice.setVisible(is_shown)
            self._labels[choice].setVisible(is_shown)
        self.hint.setText(FORMAT_HINTS.get(kind.suffix, ""))

    def _ask_where(self) -> None:
        """Show the system's file dialog. Edits made while it is open do not change what is exported."""
        kind = self.kind.value
        assert isinstance(kind, ExportKind)
        self._remember(kind)
        match kind.what:
            case ExportContent.ADAPTED:
                _ask_adapted(self._bench, kind.suffix, self.options)
            case ExportContent.STAGE:
                _ask_stage(self._bench, kind.suffix, self.options)
            case ExportContent.MOTION:
                _ask_motion(self._bench, kind.suffix)
            case ExportContent.FILM:
                size, rate = self.picture_size.value, self.rate.value
                assert isinstance(size, tuple)
                assert isinstance(rate, float)
                _ask_film(self._bench, kind.suffix, size, rate)
        self.accept()


def open_export_dialog(bench: Workbench) -> ExportDialog:
    """Show the dialog; StudioError if there is nothing to export."""
    if not exporting.chosen_performers(bench) and bench.document.active_motion_id is None:
        raise StudioError("Nothing to export: no character with a motion is shown. Show one, then export again.")
    dialog = ExportDialog(bench)
    dialog.open()
    return dialog


def _ask_adapted(bench: Workbench, suffix: str, options: ExportOptions) -> None:
    """Ask for a file for one character, or for a folder for several."""
    project, keys = bench.document.project, exporting.chosen_performers(bench)
    names = {key: file_name(project, key, suffix) for key in keys}
    if len(keys) == 1:
        [(key, name)] = names.items()
        _ask_file(bench, suffix, name, lambda path: exporting.export(bench, {key: path}, options))
        return
    ask_folder(
        bench,
        f"Export {len(keys)} adapted motions into a folder",
        lambda folder: exporting.export(bench, {key: folder / name for key, name in names.items()}, options),
    )


def _ask_stage(bench: Workbench, suffix: str, options: ExportOptions) -> None:
    _ask_file(bench, suffix, f"stage{suffix}", lambda path: exporting.export_stage(bench, path, options))


def _ask_motion(bench: Workbench, suffix: str) -> None:
    motion = bench.document.project.motions[str(bench.document.active_motion_id)]
    name = safe_name(motion.name + suffix)
    _ask_file(bench, suffix, name, lambda path: exporting.export_motion(bench, path))


def _ask_film(bench: Workbench, suffix: str, size: tuple[int, int], rate: float) -> None:
    motion_id = bench.document.active_motion_id
    name = safe_name(bench.document.project.motions[motion_id].name if motion_id else "film")
    _ask_file(bench, suffix, name + suffix, lambda path: filming.render_film(bench, path, size, rate))


def _ask_file(bench: Workbench, suffix: str, name: str, then: Callable[[Path], object]) -> None:
    kind = f"Files of this kind (*{suffix})" if suffix else "New folder (*)"
    ask_new_file(bench, "Export", kind, name, then, suffix.lstrip("."))
