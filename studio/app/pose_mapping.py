"""Controller of the pose map: groups poses in the background and shows hovered or clicked groups in other views."""

from typing import TYPE_CHECKING

import numpy as np

from studio.app.workbench import Workbench
from studio.panels.pose_map import PoseGroup, PoseMapView

if TYPE_CHECKING:
    from studio.app.strike_search import StrikeSearchController
    from studio.library.clusters import PoseMap
    from studio.library.library import Library, LibraryClip

POSE_GROUP_COUNT = 24
HIP_JOINTS, KNEE_JOINT = (12, 16), 1


class PoseMapController:
    """Controller that draws the poses of the open library in groups, and lists the clips of a clicked group."""

    def __init__(self, striking: "StrikeSearchController") -> None:
        self._striking = striking
        self.view = PoseMapView()
        self._map: PoseMap | None = None
        self._library: Library | None = None
        self.view.opened.connect(striking.search)
        self.view.group_highlighted.connect(self.show_group)
        self.view.pose_chosen.connect(self.choose)

    def show(self, library: "Library") -> None:
        """Group the poses of a library, and draw one figure per group."""
        if library is self._library:
            return

        def work(_: object) -> "tuple[PoseMap, list[PoseGroup]]":
            from studio.library.clusters import map_of

            made = map_of(library.table, POSE_GROUP_COUNT)
            return made, groups_of(made, library)

        def done(made: "tuple[PoseMap, list[PoseGroup]]") -> None:
            from studio.core.clip_search import ROW_STICKS, STICK_SIDES

            self._library, self._map = library, made[0]
            self.view.show_groups(made[1], ROW_STICKS, STICK_SIDES)

        self._striking.bench.runner.run("Drawing the map of the library", work, done)

    def show_group(self, group: int) -> None:
        """Show a ghost of the clip with the group's most typical pose, starting at that pose; a negative ``group``
        removes it.
        """
        if group < 0 or self._map is None or self._library is None:
            self._striking.show_ghost(None, 0)
            return
        clip, frame = self._library.place_of(int(self._map.representatives[group]))
        self._striking.show_ghost(clip, frame)

    def choose(self, group: int) -> None:
        """List the clips that have poses in a group, those with most poses first."""
        if self._map is None or self._library is None:
            return
        numbers = self._map.clips_of(group, self._library.table)
        self._striking.bench.window.show_dock("Strikes")
        self._striking.list_clips([self._library.clips[number] for number in numbers])


def groups_of(made: "PoseMap", library: "Library") -> "list[PoseGroup]":
    """Figures of the pose map, one for each group of poses."""
    from studio.core.clip_search import row_points

    points, places = row_points(library.table.rows[made.representatives]), made.places(library.table.rows)
    counts = np.bincount(made.clusters, minlength=len(points))
    groups = []
    for number, pose in enumerate(points):
        across = pose[HIP_JOINTS[0], :2] - pose[HIP_JOINTS[1], :2]  # from the right to the left hip
        clips: list[LibraryClip] = [library.clips[each] for each in made.clips_of(number, library.table)]
        words = f"{counts[number]} poses, {len(clips)} clip{'' if len(clips) == 1 else 's'}"
        forward = np.array([across[1], -across[0]]) / max(float(np.linalg.norm(across)), 1e-9)
        names = tuple(dict.fromkeys(clip.name for clip in clips))
        groups.append(PoseGroup(pose, forward, places[number], tuple(made.links[number].tolist()), words, names))
    return groups


def show_map(bench: Workbench) -> None:
    """Show the pose map."""
    bench.window.show_dock("Pose map")
