"""Arguments of every verb, for `VERB --help`, without importing what the verbs compute with."""

from argparse import REMAINDER, ArgumentParser, RawDescriptionHelpFormatter
from collections.abc import Callable
from pathlib import Path

import platformdirs

from studio.cli.ranges import LONGEST_SECONDS, key_press, number, size, whole
from studio.core.plausible import FRAME_RATE, PLACE_RANGE
from studio.io.export_choices import REST_POSES, ROOTS
from studio.io.joint_names import joint_namings
from studio.library.clip_labels import Kind, Limb
from studio.live.tracker import LOOPBACK, PORT
from studio.resources_folder import help_file

LIMB_WORDS = {limb.words.replace(" ", "-"): limb for limb in Limb}
STRIKE_KINDS = {kind.value.replace(" ", "-"): kind for kind in Kind if kind is not Kind.NONE}
SPACE = """
Targets of constraints are metres in the motion's own space: X forward, Y left, Z up, the origin on the ground
under the root at the motion's first frame. Times are seconds from the first frame of the file. The format of
FILE.json is told in
"""
MOST_FRAMES_READ = 100_000_000

metres = number(-PLACE_RANGE.most, PLACE_RANGE.most, "a number of metres")
seconds = number(0.0, LONGEST_SECONDS, "a number of seconds")
frame_rate = number(FRAME_RATE.least, FRAME_RATE.most, "a number of frames a second")
weight = number(0.0, 1e6, "a weight")
port = whole(1, 65_535, "a port")


def add_info_arguments(parser: ArgumentParser) -> None:
    """Add the files and the output format."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="capture, character or project")
    parser.add_argument("--json", action="store_true", help="a list with one object a file")
    add_import_options(parser)


def add_convert_arguments(parser: ArgumentParser) -> None:
    """Add the files to read and to write, and their options."""
    parser.add_argument("source", type=Path, metavar="IN", help="any capture or character that the studio reads")
    parser.add_argument("target", type=Path, metavar="OUT", help="the new file; its suffix says the format")
    parser.add_argument("--json", action="store_true", help="one object: what was written, guessed and repaired")
    add_output_options(parser)
    add_export_options(parser)
    add_import_options(parser)


def add_adapt_arguments(parser: ArgumentParser) -> None:
    """Add the capture or stage, and the options of adaptation."""
    parser.add_argument("capture", type=Path, nargs="?", metavar="CAPTURE", help="a motion of a human body")
    parser.add_argument(
        "--stage", type=Path, metavar="PROJECT|SCENE", help="all performers of a project or scene instead"
    )
    parser.add_argument(
        "--one-file", action="store_true", help="of a stage: all performers and props in one file (glTF, USD, FBX)"
    )
    add_adaptation_options(parser)


def add_batch_arguments(parser: ArgumentParser) -> None:
    """Add the options of ``adapt``, with a folder for the capture, and the processes or cluster to use."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="captures, in folders below it too")
    add_adaptation_options(parser)
    parser.add_argument(
        "--workers",
        type=whole(1, 1024, "a number of processes"),
        metavar="N",
        help="processes on this machine; as many as it has cores",
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="a running Dask cluster instead, such as tcp://host:8786"
    )


def add_index_arguments(parser: ArgumentParser) -> None:
    """Add the folders and the library."""
    parser.add_argument("folders", nargs="*", type=Path, metavar="FOLDER", help="captures here and in folders below")
    add_library_options(parser)
    parser.add_argument("--json", action="store_true", help="print clips and problems as JSON instead of a table")


def add_search_arguments(parser: ArgumentParser) -> None:
    """Add the pose, the body, the target, and the filters of clips."""
    parser.add_argument("capture", type=Path, metavar="CAPTURE", help="the motion that the character is in")
    parser.add_argument(
        "--frame",
        type=whole(0, MOST_FRAMES_READ, "a frame"),
        default=0,
        metavar="N",
        help="the frame of it from which to go on",
    )
    parser.add_argument("--character", default="actor", metavar="NAME|FILE", help="by default the capture's own actor")
    parser.add_argument(
        "--target",
        type=metres,
        nargs=3,
        required=True,
        metavar=("X", "Y", "Z"),
        help="metres forward and to the left of the root's place on the ground in that frame, and above the ground",
    )
    parser.add_argument("--limb", nargs="+", choices=LIMB_WORDS, default=[], help="only clips of these limbs")
    parser.add_argument("--kind", nargs="+", choices=STRIKE_KINDS, default=[], help="only clips of these kinds")
    parser.add_argument("--tag", nargs="+", default=[], metavar="TAG", help="only clips with one of these tags")
    parser.add_argument("--posture-weight", type=weight, default=1.0, metavar="W")
    parser.add_argument("--reach-weight", type=weight, default=1.0, metavar="W")
    parser.add_argument("--in-box", action="store_true", help="leave out clips that cannot come to the target at all")
    parser.add_argument(
        "--count",
        type=whole(1, 100_000, "a number of clips"),
        default=8,
        metavar="N",
        help="how many clips are listed",
    )
    add_library_options(parser)
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def add_live_arguments(parser: ArgumentParser) -> None:
    """Add the fighter, its target and output; or the stage that plays, and the keys pressed meanwhile."""
    parser.add_argument("--stage", type=Path, metavar="PROJECT|SCENE", help="play a stage with its behaviours")
    parser.add_argument(
        "--press",
        nargs="+",
        type=key_press,
        default=[],
        metavar="KEY@S",
        help="keys that behaviours of the stage hear, and when",
    )
    parser.add_argument("--json", action="store_true", help="print what became of the stage as JSON")
    parser.add_argument("--character", default="adult_woman", metavar="NAME|FILE")
    parser.add_argument("--guard", type=Path, metavar="CAPTURE", help="a motion that begins on guard, feet in place")
    parser.add_argument("--seconds", type=seconds, default=60.0, metavar="S", help="how long it goes on")
    parser.add_argument("--head", nargs="+", metavar="NAME", help="trackers whose middle is the target, or one bone")
    parser.add_argument("--port", type=port, default=PORT, metavar="N", help="port at which trackers are heard")
    parser.add_argument("--listen", default=LOOPBACK, metavar="ADDRESS", help="loopback unless you choose another")
    parser.add_argument("--sender", nargs="+", default=[LOOPBACK], metavar="ADDRESS", help="who is listened to")
    parser.add_argument("--replay", type=Path, metavar="FILE", help="recorded datagrams in place of the network")
    parser.add_argument("--stream", type=port, metavar="PORT", help="send the fighter as VMC to this port")
    parser.add_argument("--stream-to", metavar="ADDRESS", help="who is sent to; this computer by default")
    parser.add_argument(
        "--strike-every",
        type=number(0.05, LONGEST_SECONDS, "a number of seconds"),
        metavar="S",
        help="strike by itself; else type 'left punch'",
    )
    parser.add_argument("--frozen", action="store_true", help="strike where the target was, so that it can dodge")
    parser.add_argument("--mirrored", action="store_true", help="play every clip with the other limb, too")
    parser.add_argument("--fast", action="store_true", help="do not wait for the clock")
    add_library_options(parser)


def add_formats_arguments(parser: ArgumentParser) -> None:
    """Add the output format."""
    parser.add_argument("--json", action="store_true", help="one object: formats, and failures as sentences")


def add_render_arguments(parser: ArgumentParser) -> None:
    """Add the scene to draw, the kind of file and its size."""
    parser.add_argument("source", type=Path, metavar="PROJECT|SCENE|CAPTURE", help="a project, a scene or a capture")
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="PNG|MP4|FOLDER",
        help="the picture or the film; a new folder for a picture a frame",
    )
    parser.add_argument(
        "--character",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME|FILE",
        help="characters that perform a capture; all bundled ones by default",
    )
    parser.add_argument("--time", type=seconds, metavar="S", help="moment of a picture in seconds; else the middle")
    parser.add_argument("--camera", metavar="NAME", help="look through a saved camera of the project")
    parser.add_argument(
        "--size", type=size(16, 8192), default=(1280, 720), metavar="WxH", help="pixels; 1280x720 by default"
    )
    parser.add_argument(
        "--film-rate",
        type=number(1.0, 240.0, "a number of frames a second"),
        default=30.0,
        metavar="HZ",
        help="frames a second of a film; 30",
    )
    parser.add_argument("--json", action="store_true", help="print what was written as JSON")
    add_output_options(parser)
    add_import_options(parser)


def add_bench_arguments(parser: ArgumentParser) -> None:
    """Add the capture and character to measure on, and the number of runs."""
    parser.add_argument("capture", nargs="?", type=Path, help="a human motion; a bundled one by default")
    parser.add_argument("--character", default="adult_woman", metavar="NAME|FILE", help="adult_woman by default")
    parser.add_argument(
        "--runs",
        type=whole(1, 100_000, "a number of runs"),
        default=9,
        metavar="N",
        help="runs of which the median counts; 9",
    )
    parser.add_argument("--json", action="store_true", help="a list of {name, microseconds, best, paper, aim, ratio}")


def add_adaptation_options(parser: ArgumentParser) -> None:
    """Add the options of ``adapt`` and ``batch``: characters, constraints, output and import."""
    parser.formatter_class = RawDescriptionHelpFormatter
    parser.epilog = SPACE + str(help_file())
    parser.add_argument(
        "--character",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME|FILE",
        help="bundled characters by name, character files, or 'actor': the capture's own body; by default all bundled",
    )
    parser.add_argument("--constraints", type=Path, metavar="FILE.json", help="constraints, and contacts if it has any")
    parser.add_argument("--ground", type=Path, metavar="FILE.json", help="the ground; level at 0 by default")
    parser.add_argument(
        "--place",
        nargs=4,
        action="append",
        default=[],
        metavar=("NAME", "X", "Y", "DEGREES"),
        help="where on the stage a character stands and how far it is turned: what it follows and the ground are there",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the files; made if missing")
    parser.add_argument("--format", default="bvh", metavar="SUFFIX", help="kind of the files; bvh by default")
    parser.add_argument(
        "--at-origin",
        action="store_true",
        help="write each character where its own motion begins, not where it stands on the stage",
    )
    parser.add_argument(
        "--body-only",
        action="store_true",
        help="characters do not carry the capture's fingers, props and the like along",
    )
    parser.add_argument(
        "--free-joints", action="store_true", help="let constraints bring limbs further than a person's joints go"
    )
    parser.add_argument("--exact", action="store_true", help="disable temporal smoothing")
    parser.add_argument(
        "--through-body", action="store_true", help="let arms pass through trunk, head and thighs of their own body"
    )
    parser.add_argument("--all-frames", action="store_true", help="keep the calibration pose a file may begin with")
    parser.add_argument("--by-frame", action="store_true", help="put into the report what happens in every frame, too")
    parser.add_argument("--json", action="store_true", help="print the report instead of a table")
    add_output_options(parser)
    add_export_options(parser)
    add_import_options(parser)


def add_import_options(parser: ArgumentParser) -> None:
    """Add the options of reading: unit, up axis, frame rate, floor, reference pose, markers, body map."""
    group = parser.add_argument_group("reading", "What a file does not say is guessed; say it here to overrule.")
    group.add_argument("--unit", help="m, dm, cm, mm, inch, foot, cmu, unknown, or metres a unit")
    group.add_argument(
        "--up-axis", metavar="AXIS", help="axis of the file that points up: X, Y, Z, --up-axis=-Y, or 'x y z'"
    )
    group.add_argument("--frame-rate", type=frame_rate, metavar="HZ", help="frames a second")
    group.add_argument("--floor", type=metres, metavar="METRES", help="height of the ground")
    group.add_argument("--reference", metavar="POSE", help="'zero', or the frame that stands upright")
    group.add_argument("--marker-map", type=Path, metavar="FILE.json", help="which marker of a C3D lies where")
    group.add_argument(
        "--clean", action="store_true", help="take spikes, exchanged limbs and tremble off a noisy motion"
    )
    group.add_argument(
        "--undo-swaps", action="store_true", help="exchange markers of a C3D back that took each other's name"
    )
    group.add_argument(
        "--fill-gaps",
        type=number(0.0, 60.0, "a number of seconds"),
        metavar="S",
        help="spline its gaps up to so many seconds; 0.15, 0 leaves all gaps open",
    )
    group.add_argument(
        "--smooth",
        type=number(0.01, 1000.0, "a number of Hz"),
        metavar="HZ",
        help="take out of its markers what moves faster",
    )
    group.add_argument("--body-map", type=Path, metavar="FILE.json", help="joints by part, as `info --json` prints")


def add_export_options(parser: ArgumentParser) -> None:
    """Add the options of writing: joint names, rest pose, range, frame rate and root."""
    group = parser.add_argument_group("writing")
    group.add_argument(
        "--joint-names",
        choices=tuple(joint_namings()),
        default="",
        help="as which program names them; a character from a file keeps its own joints without it",
    )
    group.add_argument(
        "--rest-pose",
        choices=tuple(REST_POSES),
        default="",
        help="pose in which every angle is zero: T-pose, or the one in which the skin is bound; T for characters",
    )
    group.add_argument(
        "--range",
        type=seconds,
        nargs=2,
        metavar=("BEGIN", "END"),
        help="seconds that are written, of the motion or of the stage; all by default",
    )
    group.add_argument("--rate", type=frame_rate, metavar="HZ", help="frames a second; those of the motion by default")
    group.add_argument(
        "--root",
        choices=tuple(filter(None, ROOTS)),
        default="",
        help="add a root joint on the floor below the hips, or keep the hips in place; by default the hips travel",
    )


def add_output_options(parser: ArgumentParser) -> None:
    """Add the option that lets files be replaced."""
    parser.add_argument("--overwrite", action="store_true", help="replace files that are there already")


def add_library_options(parser: ArgumentParser) -> None:
    """Add the folder of the motion library, and the option that adds the bundled strikes to it."""
    parser.add_argument(
        "--library",
        type=Path,
        default=library_folder(),
        metavar="DIR",
        help="folder of the library's catalogue; by default the user's own",
    )
    parser.add_argument("--bundled", action="store_true", help="take in the strikes that come with the studio first")


def library_folder() -> Path:
    """Folder of the catalogue of the user's own library."""
    return Path(platformdirs.user_data_path("morpho-studio", appauthor=False)) / "library"


def add_script_arguments(parser: ArgumentParser) -> None:
    """Add the script and its own arguments."""
    parser.add_argument("file", type=Path, metavar="FILE.py", help="a Python script that uses studio.api")
    parser.add_argument("arguments", nargs=REMAINDER, metavar="ARGUMENT", help="arguments of the script itself")


ADD_ARGUMENTS: dict[str, Callable[[ArgumentParser], None]] = {
    "info": add_info_arguments,
    "convert": add_convert_arguments,
    "adapt": add_adapt_arguments,
    "batch": add_batch_arguments,
    "index": add_index_arguments,
    "search": add_search_arguments,
    "live": add_live_arguments,
    "formats": add_formats_arguments,
    "render": add_render_arguments,
    "bench": add_bench_arguments,
    "script": add_script_arguments,
}
