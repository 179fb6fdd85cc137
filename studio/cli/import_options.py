"""Options by which the user overrules what importers guess, the same for every verb that reads captures."""

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from pathlib import Path

from studio.core.errors import StudioError
from studio.core.markers.cleaning import USUAL_STEPS, FillLongGaps, FillShortGaps, LowPass, Step, UndoSwaps
from studio.io.importing import ImportOptions
from studio.io.json_text import read_json
from studio.io.markers.maps import read_map


def add_import_options(parser: ArgumentParser) -> None:
    """Unit, up axis, frame rate, floor, reference pose, body map."""
    group = parser.add_argument_group("reading", "What a file does not say is guessed; say it here to overrule.")
    group.add_argument("--unit", help="m, cm, mm, inch, cmu, unknown, or metres a unit")
    group.add_argument("--up-axis", choices=("X", "Y", "Z"), help="axis of the file that points up")
    group.add_argument("--frame-rate", type=float, metavar="HZ", help="frames a second")
    group.add_argument("--floor", type=float, metavar="METRES", help="height of the ground")
    group.add_argument("--reference", metavar="POSE", help="'zero', or the frame that stands upright")
    group.add_argument("--marker-map", type=Path, metavar="FILE.json", help="which marker of a C3D lies where")
    group.add_argument(
        "--undo-swaps", action="store_true", help="exchange markers of a C3D back that took each other's name"
    )
    group.add_argument(
        "--fill-gaps",
        type=seconds,
        metavar="S",
        help="spline its gaps up to so many seconds; 0.15, 0 leaves all gaps open",
    )
    group.add_argument("--smooth", type=cut_off, metavar="HZ", help="take out of its markers what moves faster")
    group.add_argument("--body-map", type=Path, metavar="FILE.json", help="joints by part, as `info --json` prints")


def import_options(arguments: Namespace) -> ImportOptions:
    """What the user said; raises StudioError when the body map cannot be read or the frame rate is no rate."""
    if arguments.frame_rate is not None and not 0.0 < arguments.frame_rate < float("inf"):
        raise StudioError(f"{arguments.frame_rate:g} is not a frame rate: say how many frames a second, above 0.")
    return ImportOptions(
        unit=arguments.unit,
        up_axis=arguments.up_axis,
        frame_rate=arguments.frame_rate,
        floor=arguments.floor,
        reference=arguments.reference,
        marker_map=read_map(arguments.marker_map) if arguments.marker_map else None,
        marker_steps=_marker_steps(arguments),
        body_map=_read_body_map(arguments.body_map) if arguments.body_map else None,
    )


def seconds(text: str) -> float:
    """A time that is not negative."""
    return _number(text, 0.0, 60.0, "seconds, 0 to 60")


def cut_off(text: str) -> float:
    """A frequency above zero."""
    return _number(text, 0.01, 1000.0, "Hz, 0.01 to 1000")


def _number(text: str, least: float, most: float, words: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not least <= value <= most:
        raise ArgumentTypeError(f"'{text}' is not a number of {words}")
    return value


def _marker_steps(arguments: Namespace) -> tuple[Step, ...] | None:
    """The steps of the markers dialog, in its order; None where nothing was said of them."""
    if not (arguments.undo_swaps or arguments.fill_gaps is not None or arguments.smooth is not None):
        return None
    steps: list[Step] = [UndoSwaps()] if arguments.undo_swaps else []
    if arguments.fill_gaps != 0.0:
        steps += (
            USUAL_STEPS if arguments.fill_gaps is None else (FillShortGaps(longest=arguments.fill_gaps), FillLongGaps())
        )
    if arguments.smooth is not None:
        steps.append(LowPass(cutoff=arguments.smooth))
    return tuple(steps)


def _read_body_map(path: Path) -> dict[str, str]:
    names = read_json(path)
    if not isinstance(names, dict) or not all(isinstance(name, str) for name in names.values()):
        raise StudioError(f'{path}: a body map is a record of joints by part, {{"pelvis": "Hips", ...}}.')
    return names
