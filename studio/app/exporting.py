"""Export in the background: of adapted motions, and of the captured motion on its own skeleton."""

from collections.abc import Callable
from pathlib import Path

from studio.app.workbench import Workbench
from studio.core.captures.annotations import Annotations, labels_in_range
from studio.core.errors import StudioError
from studio.io.export import take_of_capture, write_take
from studio.io.export_options import ExportOptions
from studio.io.staged_export import take_of_performer
from studio.io.takes.exported_stage import exported_stage, write_stage
from studio.jobs.performances import stage_performances

Progress = Callable[[float, str], None]
ADAPTING_FRACTION = 0.3


def chosen_performers(bench: Workbench) -> list[str]:
    """Ids of the selected performers that are visible and have clips; of all such performers if none is selected."""
    performers = bench.document.project.performers
    ready = [key for key, each in performers.items() if each.visible and each.clips]
    selected = [key for key in bench.document.selection.of("performers") if key in ready]
    return selected or ready


def export(bench: Workbench, paths: dict[str, Path], options: ExportOptions | None = None) -> int:
    """Adapt the project and write the motion of each performer in ``paths`` to its file. Returns the id of the task."""
    project, chosen = bench.document.project, options or ExportOptions()

    def work(progress: Progress) -> list[Path]:
        progress(0.0, "Adapting")
        made = stage_performances(project)
        each_share = (1.0 - ADAPTING_FRACTION) / len(paths)
        for index, (key, path) in enumerate(paths.items()):
            if key not in made.performances:
                reason = made.failures.get(key, "Add a clip to it first.")
                raise StudioError(f"{project.performers[key].name} cannot be exported. {reason}")
            take = take_of_performer(project, key, made.performances[key], along=chosen.carries(path))
            begun = ADAPTING_FRACTION + index * each_share
            write_take(chosen.applied_to(take, path), path, partial_progress(progress, begun, each_share))
        return list(paths.values())

    task: int = bench.runner.run("Export", work, lambda written: bench.inform(exported_text(written)))
    return task


def export_stage(bench: Workbench, path: Path, options: ExportOptions | None = None) -> int:
    """Adapt the project and write all visible performers and the props to one file. Returns the id of the task."""
    project, chosen = bench.document.project, options or ExportOptions()

    def work(progress: Progress) -> list[Path]:
        progress(0.0, "Adapting")
        made = stage_performances(project)
        for key, reason in made.failures.items():
            raise StudioError(f"{project.performers[key].name} cannot be exported. {reason}")
        stage = exported_stage(project, made.performances, chosen, path)
        write_stage(stage, path, partial_progress(progress, ADAPTING_FRACTION, 1.0 - ADAPTING_FRACTION))
        return [path]

    task: int = bench.runner.run("Export", work, lambda written: bench.inform(exported_text(written)))
    return task


def export_motion(bench: Workbench, path: Path) -> int:
    """Write the active motion as captured, with its contacts and constraints. Returns the id of the task."""
    project, motion_id = bench.document.project, bench.document.active_motion_id
    if motion_id is None:
        raise StudioError("There is no motion to export. Add a clip to a character first.")
    capture = project.captures[project.motions[motion_id].capture_id]
    contacts = tuple(each for each in project.contacts_of(motion_id).values() if not each.scope.is_narrow)
    constraints = tuple(each for each in project.constraints_of(motion_id).values() if not each.scope.is_narrow)
    labels = tuple(project.labels_of(motion_id).values())
    take = take_of_capture(
        capture, Annotations(contacts, constraints, labels_in_range(labels, 0, capture.frame_count - 1))
    )

    def work(progress: Progress) -> list[Path]:
        write_take(take, path, progress)
        return [path]

    task: int = bench.runner.run("Export", work, lambda written: bench.inform(exported_text(written)))
    return task


def partial_progress(progress: Progress, begun: float, share: float) -> Progress:
    """Function for the progress of a part of the job, which begins at the fraction ``begun`` and has the length
    ``share``.
    """
    return lambda done, text: progress(begun + share * done, text)


def exported_text(written: list[Path]) -> str:
    """Message about an export, for example ``Exported kick.bvh to /home/...``."""
    if len(written) == 1:
        return f"Exported {written[0].name} to {written[0].parent}."
    return f"Exported {len(written)} files to {written[0].parent}."
