"""Motions out to files, in the background: adapted ones, and the motion itself without a body."""

import re
from collections.abc import Callable
from pathlib import Path

from studio.app.workbench import Workbench
from studio.cli.render import performances
from studio.core.annotations import Annotations
from studio.core.capture import Capture
from studio.core.carried_joints import carried_joints
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize
from studio.core.project import Project
from studio.core.solver.performing import Performance
from studio.core.solver.rows import is_plain
from studio.io.export import Take, take_of_adapted, take_of_capture, write_take
from studio.io.export_options import ExportOptions

Progress = Callable[[float, str], None]
ADAPTING_SHARE = 0.3


def chosen_performers(bench: Workbench) -> list[str]:
    """The selected performers that are shown and play something, else all such."""
    performers = bench.document.project.performers
    ready = [key for key, each in performers.items() if each.visible and each.clips]
    selected = [key for key in bench.document.selection.of("performers") if key in ready]
    return selected or ready


def file_name(project: Project, performer_id: str, suffix: str = ".bvh") -> str:
    """``front_kick tall man.bvh``: the motion and who performs it."""
    performer = project.performers[performer_id]
    motion = project.motions[performer.clips[0].motion_id]
    return safe_name(f"{motion.name} {performer.name.lower()}{suffix}")


def safe_name(name: str) -> str:
    """A name that every system allows."""
    return re.sub(r'[\\/:*?"<>|]', "_", name)


def export(bench: Workbench, paths: dict[str, Path], options: ExportOptions | None = None) -> int:
    """Adapt anew what the project asks of these performers and write their clips; returns the task."""
    project, chosen = bench.document.project, options or ExportOptions()

    def work(progress: Progress) -> list[Path]:
        progress(0.0, "Adapting")
        made = performances(project)
        each_share = (1.0 - ADAPTING_SHARE) / len(paths)
        for place, (key, path) in enumerate(paths.items()):
            if key not in made.performances:
                reason = made.failures.get(key, "It plays nothing.")
                raise StudioError(f"{project.performers[key].name} cannot be exported. {reason}")
            take = take_of_performer(project, key, made.performances[key], along=chosen.carries(path))
            begun = ADAPTING_SHARE + place * each_share
            write_take(chosen.applied_to(take, path), path, partly(progress, begun, each_share))
        return list(paths.values())

    task: int = bench.runner.run("Export", work, lambda written: bench.said.emit(words_of(written)))
    return task


def take_of_performer(project: Project, performer_id: str, performance: Performance, *, along: bool = False) -> Take:
    """What one performer plays on its character; ``along`` has it carry the other joints of its only capture."""
    performer, timing = project.performers[performer_id], performance.composite.timing
    character = project.characters[performer.character_id]
    played = performance.adapted.frames(timing.first, timing.last)
    clips = performer.clips
    capture = project.captures[project.motions[clips[0].motion_id].capture_id]
    alone = len(clips) == 1 and is_plain(clips[0])
    carried = (capture, normalize(capture)[1]) if along and alone and other_joints(capture) else None
    return take_of_adapted(performer.name, played, character, performance.request, carried)


def other_joints(capture: Capture) -> tuple[str, ...]:
    """The capture's joints that a character can carry along."""
    if capture.body_map is None:
        return ()
    skeleton = capture.skeleton
    carried = carried_joints(skeleton, capture.body_map)
    return tuple(skeleton.names[joint] for joint in carried if not skeleton.end_sites[joint])


def export_motion(bench: Workbench, path: Path) -> int:
    """Write the active motion as it was captured, with its contacts and constraints; returns the task."""
    project, motion_id = bench.document.project, bench.document.active_motion_id
    if motion_id is None:
        raise StudioError("No motion plays: there is none to export.")
    capture = project.captures[project.motions[motion_id].capture_id]
    contacts = tuple(each for each in project.contacts_of(motion_id).values() if not each.scope.is_narrow)
    constraints = tuple(each for each in project.constraints_of(motion_id).values() if not each.scope.is_narrow)
    take = take_of_capture(capture, Annotations(contacts, constraints))

    def work(progress: Progress) -> list[Path]:
        write_take(take, path, progress)
        return [path]

    task: int = bench.runner.run("Export", work, lambda written: bench.said.emit(words_of(written)))
    return task


def partly(progress: Progress, begun: float, share: float) -> Progress:
    """Progress of a part of the job, which begins at ``begun`` and is ``share`` of the whole."""
    return lambda done, text: progress(begun + share * done, text)


def words_of(written: list[Path]) -> str:
    """``Exported kick.bvh to /home/…``."""
    if len(written) == 1:
        return f"Exported {written[0].name} to {written[0].parent}."
    return f"Exported {len(written)} files to {written[0].parent}."
