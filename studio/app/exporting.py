"""Adapted motions out to files, in the background."""

import re
from collections.abc import Callable
from pathlib import Path

from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.io.export import take_of_adapted, write_take


def chosen_performers(bench: Workbench) -> list[str]:
    """The selected performers that are shown and play something, else all such."""
    performers = bench.document.project.performers
    ready = [key for key, each in performers.items() if each.visible and each.clips]
    selected = [key for key in bench.document.selection.of("performers") if key in ready]
    return selected or ready


def file_name(bench: Workbench, performer_id: str) -> str:
    """``front_kick tall man.bvh``: the motion and who performs it."""
    project = bench.document.project
    performer = project.performers[performer_id]
    motion = project.motions[performer.clips[0].motion_id]
    return re.sub(r'[\\/:*?"<>|]', "_", f"{motion.name} {performer.name.lower()}.bvh")


def export(bench: Workbench, paths: dict[str, Path]) -> int:
    """Write each performer's newest result; returns the task."""
    project = bench.document.project
    jobs = []
    for key, path in paths.items():
        adapted = bench.live.result(key)
        performer = project.performers[key]
        if adapted is None:
            raise StudioError(f"{performer.name} is still being adapted. Export again in a moment.")
        jobs.append((adapted, project.characters[performer.character_id], performer.name, path))

    def work(progress: Callable[[float, str], None]) -> list[Path]:
        for place, (adapted, character, name, path) in enumerate(jobs):
            progress(place / len(jobs), path.name)
            write_take(take_of_adapted(name, adapted, character), path)
        return [path for *_, path in jobs]

    task: int = bench.runner.run("Export", work, lambda written: bench.said.emit(_words(written)))
    return task


def _words(written: list[Path]) -> str:
    if len(written) == 1:
        return f"Exported {written[0].name} to {written[0].parent}."
    return f"Exported {len(written)} files to {written[0].parent}."
