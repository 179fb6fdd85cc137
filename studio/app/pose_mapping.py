"""Pose map in the window: computed in the background; hovered and chosen groups are shown in other views."""

from typing import TYPE_CHECKING

import numpy as np

from studio.app.workbench import Workbench
from studio.panels.pose_map import PoseGroup, PoseMapView

if TYPE_CHECKING:
    from studio.app.strike_search import StrikeSearchController
    from studio.library.clusters import PoseMap
    from studio.library.library import Library, LibraryClip

GROUPS = 24
HIP_JOINTS, KNEE_JOINT = (12, 16), 1


class PoseMapController:
    """Controller of the pose map: draws the open library's poses in groups, and lists the clips of a chosen group."""

    def __init__(self, striking: "StrikeSearchController") -> None:
        self._striking = striking
        self.view = PoseMapView()
        self._map: PoseMap | None = None
        self._library: Library | None = None
        self.view.opened.connect(striking.search)
        self.view.group_highlighted.connect(self.show_group)
        self.view.pose_chosen.connect(self.choose)

    def show(self, library: "Library") -> None:
        """Group the poses of a library, and draw them."""
        if library is self._library:
            return

        def work(_: object) -> "tuple[PoseMap, list[PoseGroup]]":
            from studio.library.clusters import map_of

            made = map_of(library.table, GROUPS)
            return made, groups_of(made, library)

        def done(made: "tuple[PoseMap, list[PoseGroup]]") -> None:
            from studio.core.clip_search import ROW_STICKS, STICK_SIDES

            self._library, self._map = library, made[0]
            self.view.show_groups(made[1], ROW_STICKS, STICK_SIDES)

        self._striking.bench.runner.run("Drawing the map of the library", work, done)

    def show_group(self, group: int) -> None:
        """Show the clip of a group's most typical pose as a ghost, from that pose on; none if ``group`` is negative."""
        if group < 0 or self._map is None or self._library is None:
            self._striking.show_ghost(None, 0)
            return
        clip, frame = self._library.place_of(int(self._map.representatives[group]))
        self._striking.show_ghost(clip, frame)

    def choose(self, group: int) -> None:
        """List the clips with poses in a group, those with most of them first."""
        if self._map is None or self._library is None:
            return
        numbers = self._map.clips_of(group, self._library.table)
        self._striking.bench.window.show_dock("Strikes")
        self._striking.list_clips([self._library.clips[number] for number in numbers])


def groups_of(made: "PoseMap", library: "Library") -> "list[PoseGroup]":
    """Figures of the map, one for each group of poses."""
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
    """Open the map."""
    bench.window.show_dock("Pose map")
