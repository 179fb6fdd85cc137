"""Onion skins: characters at frames before and after the playhead, and ghosts added by the user."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from studio.core.stage.project import Project
from studio.document import colours
from studio.engine.posed_performer import PosedPerformer, pose_of

NEAREST_OPACITY, FARTHEST_OPACITY = 0.38, 0.12
"""Opacity of the onion skin next to the playhead, which added ghosts have too, and of the farthest one."""


@dataclass(frozen=True)
class OnionSkins:
    """Numbers of onion skins before and after the playhead, and of frames between two of them."""

    before: int = 3
    after: int = 3
    step: int = 4


@dataclass(frozen=True, eq=False)
class Ghost:
    """Translucent pose of a character at another moment."""

    pose: PosedPerformer
    colour: str
    opacity: float


def onion_ghosts(
    project: Project, poses: Mapping[str, PosedPerformer], skins: OnionSkins, time: float, frame_rate: float
) -> Iterator[Ghost]:
    """Onion skins for performers with ``poses`` at the stage time ``time``, ``skins.step`` frames apart.

    None is beyond the ends of the motion. They show the newest complete motion, and so follow a drag after the clip is
    solved again.
    """
    for performer_id, pose in poses.items():
        for sign, count, colour in (
            (-1, skins.before, colours.BEFORE_PLAYHEAD),
            (1, skins.after, colours.AFTER_PLAYHEAD),
        ):
            last = pose.frame
            for index in range(1, count + 1):
                moment = time + sign * index * skins.step / frame_rate
                ghost = pose_of(project, performer_id, pose.over_time, moment)
                if ghost.frame == last:
                    break
                last = ghost.frame
                faded = (index - 1) / max(count - 1, 1)
                yield Ghost(ghost, colour, NEAREST_OPACITY + faded * (FARTHEST_OPACITY - NEAREST_OPACITY))


def kept_ghosts(
    project: Project, posed: Mapping[str, PosedPerformer], kept: Iterable[tuple[str, float]]
) -> Iterator[Ghost]:
    """Ghosts added by the user at (performer id, stage time in seconds), as currently adapted."""
    for performer_id, time in kept:
        pose = posed.get(performer_id)
        if pose is not None and not pose.resting:
            ghost = pose_of(project, performer_id, pose.over_time, time)
            if ghost.frame != pose.frame:
                yield Ghost(ghost, colours.KEPT_GHOST, NEAREST_OPACITY)
