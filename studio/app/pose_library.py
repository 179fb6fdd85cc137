"""Pose library: poses of the active character are saved, and applied as keys of a correction layer."""

from collections.abc import Callable
from pathlib import Path

from PySide6.QtGui import QIcon, QPixmap

from studio.app.workbench import Workbench
from studio.cli.arguments import library_folder
from studio.core.errors import StudioError
from studio.core.names import free_name
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.correction import PoseOffsets
from studio.core.stage.local_pose import POSE_REGIONS, local_pose, offsets_towards
from studio.document.correction_edits import correction_at, set_pose
from studio.engine.correction_range import with_fitted_fades
from studio.engine.posed_performer import PosedPerformer, pose_of
from studio.library.saved_poses import SavedPose, delete_pose, read_poses, rename_pose, write_pose
from studio.panels.pose_list import PosePanel
from studio.panels.thumbnails import pose_picture

REGIONS_WITH_HIPS = ("Whole body", "Legs")
"""Body regions with which the saved height of the hips is applied too."""
NO_POSE_MESSAGE = (
    "No selected character shows a pose at the playhead. Select one that plays a clip, and wait until it is adapted."
)


class PoseLibrary:
    """Controller that connects the panel of saved poses, their files and the document."""

    def __init__(self, bench: Workbench, folder: Path | None = None) -> None:
        self._bench, self._folder = bench, folder or library_folder() / "poses"
        self.panel = PosePanel(POSE_REGIONS)
        self._saved: list[SavedPose] = []
        self.panel.save_requested.connect(lambda: self._try(self.save))
        self.panel.apply_requested.connect(lambda row: self._try(lambda: self.apply(row)))
        self.panel.delete_requested.connect(lambda row: self._try(lambda: self.delete(row)))
        self.panel.pose_renamed.connect(lambda row, name: self._try(lambda: self.rename(row, name)))
        self._list()

    def save(self) -> None:
        """Save the pose of the active performer at the playhead; the user types the name in the list."""
        _, shown = self._shown()
        motion = shown.motion
        pose = local_pose(motion.morphology.layout, motion.rotations[shown.row], _hips_height(shown))
        name = free_name("Pose 1", {each.name for each in self._saved})
        self.panel.edit_name(self._list(write_pose(self._folder, name, pose).path))

    def apply(self, row: int) -> None:
        """Set a correction key at the playhead that brings the chosen body region of the active performer to the pose
        in ``row``.
        """
        document, saved, (performer_id, shown) = self._bench.document, self._saved[row], self._shown()
        time, region, fraction = document.playhead.time, str(self.panel.region.value), self.panel.fraction
        correction = document.project.corrections.get(correction_at(document, performer_id, time) or "")
        weight = correction.weight if correction else 1.0
        acting = correction.pose_at(time).scaled(weight) if correction else PoseOffsets()
        layout, rotations = shown.motion.morphology.layout, shown.motion.rotations[shown.row]
        turns = offsets_towards(layout, rotations, saved.pose, POSE_REGIONS[region], fraction, dict(acting.turns))
        rise = fraction * (saved.pose.hips_height - _hips_height(shown)) if region in REGIONS_WITH_HIPS else 0.0
        x, y, z = acting.hips
        wanted = PoseOffsets(tuple(turns.items()), (x, y, z + rise)).scaled(1.0 / weight)
        keyed = {part: wanted.turn(part) for part in turns}
        hips = wanted.hips if region in REGIONS_WITH_HIPS else None
        motion = self._bench.live.result(performer_id) or shown.motion
        text, timing = f"Apply pose '{saved.name}'", timing_of(document.project, shown.performer)
        with document.group(text):
            key = set_pose(document, performer_id, time, keyed, hips, text=text, name=saved.name)
            posed = document.project.corrections[key]
            document.replace("corrections", key, with_fitted_fades(posed, correction, timing, motion, time), text)

    def apply_to(self, row: int, performer_id: str) -> None:
        """Select a performer and apply the pose in ``row`` to it."""
        self._bench.document.selection.set(("performers", performer_id))
        self._try(lambda: self.apply(row))

    def rename(self, row: int, name: str) -> None:
        """Rename the pose in ``row``; an empty or used name is refused with a message."""
        saved = self._saved[row]
        taken = {each.name for each in self._saved if each is not saved}
        path = saved.path
        try:
            if not name or name in taken:
                raise StudioError(
                    f"A pose cannot have the name '{name}', which is empty or used already. Type another one."
                )
            path = rename_pose(saved, name).path if name != saved.name else path
        finally:
            self._list(path)

    def delete(self, row: int) -> None:
        """Delete the file of the pose in ``row``."""
        delete_pose(self._saved[row])
        self._list()

    def _list(self, current: Path | None = None) -> int:
        """Show the poses of the folder in the list. Returns the row of the file ``current``, or -1."""
        self._saved, problems = read_poses(self._folder)
        row = next((index for index, each in enumerate(self._saved) if each.path == current), -1)
        listed = [(each.name, QIcon(QPixmap.fromImage(pose_picture(each.pose)))) for each in self._saved]
        self.panel.show_poses(listed, problems, row)
        return row

    def _shown(self) -> tuple[str, PosedPerformer]:
        """Id and pose at the playhead of the active performer."""
        document = self._bench.document
        key = document.active_performer_id or ""
        performer, motion = document.project.performers.get(key), self._bench.live.shown_frame(key)
        if performer is None or motion is None or not performer.clips:
            raise StudioError(NO_POSE_MESSAGE)
        return key, pose_of(document.project, key, motion, document.playhead.time)

    def _try(self, work: Callable[[], None]) -> None:
        try:
            work()
        except StudioError as error:
            self._bench.post_message(str(error))


def _hips_height(shown: PosedPerformer) -> float:
    """Height of the hips above the ground in leg lengths."""
    return float(shown.motion.positions[shown.row, 0, 2]) / shown.motion.body.leg_length
