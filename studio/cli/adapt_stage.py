"""``adapt --stage``: adapt all performers of a project as the window plays them, and write and report their motions."""

from argparse import Namespace
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from studio.cli.export_arguments import export_options
from studio.cli.outputs import refuse_replacing
from studio.cli.printing import QUALITY_TITLES, print_json, print_table
from studio.core.errors import StudioError
from studio.core.names import safe_name
from studio.core.quality.metrics import MotionPeaks
from studio.core.solver.adapt import grounded_motion
from studio.core.solver.performers.staged_performances import Performance
from studio.core.solver.source import motion_on_body
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project
from studio.io.export import write_take
from studio.io.json_text import JsonObject, write_json
from studio.io.registry import known_formats
from studio.io.staged_export import take_of_performer
from studio.io.takes.exported_stage import exported_stage, write_stage
from studio.jobs.adapt_report import place_record, quality_record
from studio.jobs.adaptation import make_folder
from studio.jobs.bundled_scenes import open_project
from studio.jobs.performances import stage_performances
from studio.startup.kernel_warm_up import compile_first

CAPTURE_ARGUMENTS = ("capture", "character", "constraints", "ground", "place")
"""Arguments that a project provides itself, and that ``--stage`` therefore refuses."""


def run_stage(arguments: Namespace) -> int:
    """Adapt, export and report; return 1 if a performer failed, while the others are written."""
    given = [name for name in CAPTURE_ARGUMENTS if getattr(arguments, name)]
    if given:
        what = "another motion" if given[0] == "capture" else f"--{given[0]}"
        raise StudioError(f"--stage adapts a project, which has all of its own: leave out {what}.")
    suffix = f".{arguments.format.lower().lstrip('.')}"
    known = known_formats().suffixes("stage_writer" if arguments.one_file else "motion_writer")
    if suffix not in known:
        what = "a whole stage" if arguments.one_file else "motions"
        raise StudioError(f"'{arguments.format}' is not a file format for {what}: choose {', '.join(known)}.")
    options = export_options(arguments)
    options.check(Path(f"motion{suffix}"))
    project = with_solver_options(open_project(arguments.stage), arguments)
    paths = {key: arguments.out / name for key, name in file_names(project, suffix).items()}
    if arguments.one_file:
        paths = dict.fromkeys(paths, arguments.out / f"{arguments.stage.stem}{suffix}")
    if not paths:
        raise StudioError(f"No visible character of {arguments.stage.name} has a motion: there is nothing to adapt.")
    written = arguments.out / "report.json"
    refuse_replacing([*paths.values(), written], arguments.stage, arguments.overwrite)
    compile_first()
    made = stage_performances(project)
    make_folder(arguments.out)
    if arguments.one_file:
        path = next(iter(paths.values()))
        write_stage(exported_stage(project, made.performances, options, path), path)
    else:
        for key, performance in made.performances.items():
            take = take_of_performer(project, key, performance, along=options.carries(paths[key]))
            write_take(options.applied_to(take, paths[key]), paths[key])
    records = [
        performer_record(project, key, performance, paths[key], by_frame=arguments.by_frame)
        for key, performance in made.performances.items()
    ]
    failed = [{"name": project.performers[key].name, "error": reason} for key, reason in made.failures.items()]
    report = {"ok": not failed, "source": str(arguments.stage), "performers": records, "failed": failed}
    write_json(written, report)
    if arguments.json:
        print_json(report)
    else:
        print_stage(report)
        print("\nWritten:", *dict.fromkeys(paths[key] for key in made.performances), written, sep="\n  ")
    return 1 if failed else 0


def with_solver_options(project: Project, arguments: Namespace) -> Project:
    """Project with joint limits and temporal smoothing disabled as the command line says."""
    performers = [
        (
            key,
            replace(each, limited=each.limited and not arguments.free_joints, eased=each.eased and not arguments.exact),
            None,
        )
        for key, each in project.performers.items()
    ]
    return project.with_entities("performers", performers)


def file_names(project: Project, suffix: str) -> dict[str, str]:
    """File name of every visible performer with clips; numbered if several have the same name."""
    names: dict[str, str] = {}
    for key, performer in project.performers.items():
        if performer.visible and performer.clips:
            stem = safe_name(performer.name.lower())
            names[key] = f"{_free(stem, names.values(), suffix)}{suffix}"
    return names


def _free(stem: str, taken: Iterable[str], suffix: str) -> str:
    names, number, name = {*taken}, 1, stem
    while f"{name}{suffix}" in names:
        number += 1
        name = f"{stem} {number}"
    return name


def performer_record(project: Project, key: str, performance: Performance, path: Path, *, by_frame: bool) -> JsonObject:
    """Part of the report about one performer."""
    request, composite = performance.request, performance.composite
    source = motion_on_body(composite.motion, request.actor or request.morphology.first_frame_body)
    peaks = MotionPeaks.of_source(source, performance.adapted_on_stage)
    performer = project.performers[key]
    return {
        "name": performer.name,
        "file": str(path),
        "place": place_record(Placement.of(performer)),
        "clips": [project.motions[clip.motion_id].name for clip in performer.clips],
        "begin": composite.timing.start,
        "frame_rate": composite.timing.frame_rate,
        "sweeps": performance.iterations,
        **quality_record(grounded_motion(request), request, performance.adapted_on_stage, peaks, by_frame),
    }


def print_stage(report: JsonObject) -> None:
    """Print one line for each performer, one for each constraint, and the failures."""
    rows = [[each["name"], *(f"{each[key]:.2f}" for key in QUALITY_TITLES)] for each in report["performers"]]
    print_table(("performer", *QUALITY_TITLES.values()), rows)
    lines = [
        [asked["name"], each["name"], f"{asked['frames_held']} of {asked['frames_asked']}"]
        for each in report["performers"]
        for asked in each["constraints"]
    ]
    if lines:
        print()
        print_table(("constraint", "character", "frames met"), lines)
    for each in report["failed"]:
        print(f"\n{each['name']} failed: {each['error']}")
