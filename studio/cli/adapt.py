"""``adapt``: a capture on many characters, as files, with a report of what was reached."""

from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

from studio.cli.adapt_report import Record, character_report
from studio.cli.adaptation import MOTION_ID, ReadyCapture, chosen_characters, make_folder, ready_capture
from studio.cli.import_options import add_import_options, import_options
from studio.cli.printing import print_json, print_table
from studio.core.character import Character
from studio.core.errors import StudioError
from studio.core.solver.request import AdaptRequest
from studio.io.constraint_file import ConstraintFile, read_constraints
from studio.io.export import take_of_adapted, write_take
from studio.io.report_file import write_json

SPACE = """
Targets of constraints are metres in the motion's own space: X forward, Y left, Z up, the origin on the ground
under the root at the motion's first frame. Times are seconds from the first frame of the file. The format of
FILE.json is told in docs/headless.md.
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Capture, characters, constraints, where to write."""
    parser.formatter_class = RawDescriptionHelpFormatter
    parser.epilog = SPACE
    parser.add_argument("capture", type=Path, metavar="CAPTURE", help="a motion of a human body")
    parser.add_argument(
        "--character",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME|FILE",
        help="bundled characters by name, or character files; all bundled ones by default",
    )
    parser.add_argument("--constraints", type=Path, metavar="FILE.json", help="constraints, and contacts if it has any")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the files; made if missing")
    parser.add_argument("--all-frames", action="store_true", help="keep the calibration pose a file may begin with")
    parser.add_argument("--json", action="store_true", help="print the report instead of a table")
    add_import_options(parser)


def run(arguments: Namespace) -> int:
    """Adapt, export, report."""
    characters = chosen_characters(arguments.character)
    ready = ready_capture(arguments.capture, import_options(arguments), all_frames=arguments.all_frames)
    asked = ConstraintFile((), None)
    if arguments.constraints is not None:
        asked = read_constraints(arguments.constraints, MOTION_ID)
        check_frames(asked, ready, arguments.constraints)
    make_folder(arguments.out)
    records = [adapt_to(character, key, ready, asked, arguments.out) for key, character in characters.items()]
    report = {
        "source": str(arguments.capture),
        "frames": ready.capture.frame_count - ready.capture.first_frame,
        "first_frame": ready.capture.first_frame,
        "frame_rate": ready.capture.frame_rate,
        "contacts": "detected" if asked.contacts is None else "given",
        "characters": records,
    }
    write_json(arguments.out / "report.json", report)
    if arguments.json:
        print_json(report)
    else:
        print_report(report)
    return 0


def adapt_to(character: Character, key: str, ready: ReadyCapture, asked: ConstraintFile, folder: Path) -> Record:
    """One character's file and its part of the report."""
    contacts = ready.contacts if asked.contacts is None else asked.contacts
    constraints = tuple(each for each in asked.constraints if each.enabled)
    request = AdaptRequest(ready.motion, character.morphology, contacts, constraints)
    adapted, record = character_report(request, ready.source, ready.capture.first_frame)
    path = folder / f"{ready.capture.name}_{key}.bvh"
    write_take(take_of_adapted(character.name, adapted, character, request), path)
    return {"name": key, "file": str(path), **record}


def check_frames(asked: ConstraintFile, ready: ReadyCapture, path: Path) -> None:
    """Raise StudioError for a contact beyond the end of the motion."""
    last = ready.capture.frame_count - 1
    for contact in asked.contacts or ():
        if contact.last > last:
            raise StudioError(f"{path}, contacts, {contact.point}: frame {contact.last} is after the last, {last}.")


def print_report(report: Record) -> None:
    """The report as tables: one line a character, one line a constraint and character."""
    print(f"{report['source']}: {report['frames']} frames at {report['frame_rate']:g} Hz\n")
    titles = ("character", "slide mm", "float mm", "below ground mm", "acceleration ratio", "speed ratio", "us/frame")
    keys = ("slide_mm", "float_mm", "penetration_mm", "acceleration_ratio", "speed_ratio", "microseconds_per_frame")
    rows = [[record["name"], *(f"{record[key]:.2f}" for key in keys)] for record in report["characters"]]
    print_table(titles, rows)
    lines = [
        [each["name"], record["name"], _residual(each), _yes(each["reached"])]
        for record in report["characters"]
        for each in record["constraints"]
    ]
    if lines:
        print()
        print_table(("constraint", "character", "residual", "reached"), lines)
    print("\nWritten:", *(record["file"] for record in report["characters"]), sep="\n  ")


def _residual(record: Record) -> str:
    if record["residual_deg"] is not None:
        return f"{record['residual_deg']:.3f} deg"
    return "-" if record["residual_mm"] is None else f"{record['residual_mm']:.3f} mm"


def _yes(reached: bool | None) -> str:
    return "never fully active" if reached is None else "yes" if reached else "no"
