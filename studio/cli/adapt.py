"""``adapt``: adapt a capture to many characters, write the motions as files, and report their quality."""

import math
from argparse import Namespace
from collections.abc import Sequence

from studio.cli.adapt_stage import run_stage
from studio.cli.export_arguments import export_options
from studio.cli.import_arguments import import_options
from studio.cli.outputs import refuse_replacing
from studio.cli.printing import QUALITY_TITLES, print_json, print_table
from studio.core.errors import StudioError
from studio.core.names import counted_noun
from studio.core.plausible import PLACE_RANGE
from studio.core.stage.placement import Placement
from studio.io.json_text import JsonObject, write_json
from studio.jobs.adapted_files import AdaptSettings, adapt_file, file_name
from studio.jobs.batch_summary import summary_rows, write_rows
from studio.startup.kernel_warm_up import compile_first


def run(arguments: Namespace) -> int:
    """Adapt, export and report, and return the exit code."""
    if arguments.stage is not None:
        return run_stage(arguments)
    if arguments.one_file:
        raise StudioError("--one-file holds a whole stage: name a project or a scene with --stage.")
    if arguments.capture is None:
        raise StudioError("Name a capture to adapt, or a project with --stage.")
    settings = adapt_settings(arguments)
    cast = settings.cast()
    reports = [arguments.out / name for name in ("report.json", "report.csv")]
    motions = [arguments.out / file_name(arguments.capture, key, settings.suffix) for key in cast.characters]
    refuse_replacing([*motions, *reports], arguments.capture, arguments.overwrite)
    compile_first()
    report = adapt_file(arguments.capture, settings, cast, arguments.out)
    write_json(reports[0], report)
    write_rows(reports[1], summary_rows([{**report, "name": arguments.capture.stem}]))
    if arguments.json:
        print_json(report)
    else:
        print_report(report)
        print("\nWritten:", *motions, *reports, sep="\n  ")
    return 0


def adapt_settings(arguments: Namespace) -> AdaptSettings:
    """Settings from the arguments of ``adapt`` and ``batch``. Raises StudioError for a map that cannot be read."""
    return AdaptSettings(
        characters=tuple(arguments.character),
        places=placements_of_words(arguments.place),
        constraints=arguments.constraints,
        ground=arguments.ground,
        on_steps=arguments.on_steps,
        suffix=f".{arguments.format.lower().lstrip('.')}",
        reading=import_options(arguments),
        writing=export_options(arguments),
        all_frames=arguments.all_frames,
        by_frame=arguments.by_frame,
        limited=not arguments.free_joints,
        eased=not arguments.exact,
        clears=not arguments.through_body,
    )


def placements_of_words(said: Sequence[Sequence[str]]) -> dict[str, Placement]:
    """Placement by character from the words of ``--place``: name, x, y, degrees. Raises StudioError for bad numbers."""
    places = {}
    for name, *numbers in said:
        try:
            x, y, degrees = map(float, numbers)
        except ValueError:
            x = y = degrees = math.nan
        if not all(abs(number) <= PLACE_RANGE.most for number in (x, y, degrees)):
            raise StudioError(
                f"--place {name} {' '.join(numbers)}: give two lengths in metres and an angle in degrees."
            )
        places[name] = Placement((x, y), math.radians(degrees))
    return places


def print_report(report: JsonObject) -> None:
    """Print the report as tables: one line for each character, and one for each constraint and character."""
    print(f"{report['source']}: {counted_noun(report['frames'], 'frame')} at {report['frame_rate']:g} fps\n")
    titles = ("character", *QUALITY_TITLES.values(), "us/frame")
    keys = (*QUALITY_TITLES, "microseconds_per_frame")
    rows = [[record["name"], *(f"{record[key]:.2f}" for key in keys)] for record in report["characters"]]
    print_table(titles, rows)
    lines = [
        [
            *(each["name"], record["name"], _residual(each), _yes(each["reached"])),
            *(f"{each['frames_held']} of {each['frames_asked']}", ", ".join(each["kept_by"]) or "-"),
        ]
        for record in report["characters"]
        for each in record["constraints"]
    ]
    if lines:
        print()
        print_table(("constraint", "character", "error", "reached", "frames met", "limited by"), lines)


def _residual(record: JsonObject) -> str:
    if record["residual_deg"] is not None:
        return f"{record['residual_deg']:.3f} deg"
    return "-" if record["residual_mm"] is None else f"{record['residual_mm']:.3f} mm"


def _yes(reached: bool | None) -> str:
    return "never fully active" if reached is None else "yes" if reached else "no"
