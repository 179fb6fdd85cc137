"""Arguments of every verb, for ``VERB --help``, without importing the code that the verbs run."""

from argparse import REMAINDER, ArgumentParser, RawDescriptionHelpFormatter
from collections.abc import Callable
from pathlib import Path

import platformdirs

from studio.cli.ranges import LONGEST_SECONDS, key_press, number_parser, size_parser, whole_parser
from studio.core.plausible import FRAME_RATE_RANGE, PLACE_RANGE
from studio.io.export_choices import REST_POSES, ROOT_CHOICES
from studio.io.joint_names import joint_namings
from studio.library.clip_labels import Kind, Limb
from studio.live.tracker import LOOPBACK, PORT
from studio.resources_folder import help_file

LIMB_WORDS = {limb.words.replace(" ", "-"): limb for limb in Limb}
STRIKE_KINDS = {kind.value.replace(" ", "-"): kind for kind in Kind if kind is not Kind.NONE}
MOTION_SPACE_HELP = """
Targets of constraints are metres in the motion's own space: X forward, Y left, Z up, the origin on the ground
under the root at the motion's first frame. Times are seconds from the first frame of the file. The format of
FILE.json is told in
"""
"""Text of the help about the space of targets."""
MOST_FRAMES_READ = 100_000_000

metres = number_parser(-PLACE_RANGE.most, PLACE_RANGE.most, "a number of metres")
seconds = number_parser(0.0, LONGEST_SECONDS, "a number of seconds")
frame_rate = number_parser(FRAME_RATE_RANGE.least, FRAME_RATE_RANGE.most, "a number of frames per second")
weight = number_parser(0.0, 1e6, "a weight")
port = whole_parser(1, 65_535, "a port")


def add_info_arguments(parser: ArgumentParser) -> None:
    """Add the files and the output format."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="capture, character or project")
    parser.add_argument("--json", action="store_true", help="a list with one object per file")
    add_import_options(parser)


def add_convert_arguments(parser: ArgumentParser) -> None:
    """Add the files to read and to write, and their options."""
    parser.add_argument("source", type=Path, metavar="IN", help="input capture or character")
    parser.add_argument("target", type=Path, metavar="OUT", help="output file; the extension sets the format")
    parser.add_argument("--json", action="store_true", help="one object: what was written, assumed and repaired")
    add_output_options(parser)
    add_export_options(parser)
    add_import_options(parser)


def add_adapt_arguments(parser: ArgumentParser) -> None:
    """Add the capture or stage, and the options of adaptation."""
    parser.add_argument("capture", type=Path, nargs="?", metavar="CAPTURE", help="a motion of a human body")
    parser.add_argument(
        "--stage", type=Path, metavar="PROJECT|SCENE", help="all characters of a project or scene instead"
    )
    parser.add_argument(
        "--one-file", action="store_true", help="of a stage: all characters and props in one file (glTF, USD, FBX)"
    )
    add_adaptation_options(parser)


def add_batch_arguments(parser: ArgumentParser) -> None:
    """Add the options of ``adapt``, with a folder for the capture, and the processes or cluster to use."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of captures, searched recursively")
    add_adaptation_options(parser)
    parser.add_argument(
        "--workers",
        type=whole_parser(1, 1024, "a number of processes"),
        metavar="N",
        help="worker processes on this machine (default: number of cores)",
    )
    parser.add_argument("--scheduler", metavar="ADDRESS", help="use a running Dask cluster, such as tcp://host:8786")


def add_index_arguments(parser: ArgumentParser) -> None:
    """Add the folders and the library."""
    parser.add_argument(
        "folders", nargs="*", type=Path, metavar="FOLDER", help="folders of captures, searched recursively"
    )
    add_library_options(parser)
    parser.add_argument("--json", action="store_true", help="print clips and problems as JSON instead of a table")


def add_search_arguments(parser: ArgumentParser) -> None:
    """Add the pose, the body, the target, and the filters of clips."""
    parser.add_argument("capture", type=Path, metavar="CAPTURE", help="capture the character is playing")
    parser.add_argument(
        "--frame",
        type=whole_parser(0, MOST_FRAMES_READ, "a frame"),
        default=0,
        metavar="N",
        help="frame to continue from",
    )
    parser.add_argument("--character", default="actor", metavar="NAME|FILE", help="default: the captured actor")
    parser.add_argument(
        "--target",
        type=metres,
        nargs=3,
        required=True,
        metavar=("X", "Y", "Z"),
        help="target in metres: forward and left of the root on the ground in that frame, and above the ground",
    )
    parser.add_argument("--limb", nargs="+", choices=LIMB_WORDS, default=[], help="only clips of these limbs")
    parser.add_argument("--kind", nargs="+", choices=STRIKE_KINDS, default=[], help="only clips of these types")
    parser.add_argument("--tag", nargs="+", default=[], metavar="TAG", help="only clips with one of these tags")
    parser.add_argument("--posture-weight", type=weight, default=1.0, metavar="W")
    parser.add_argument("--reach-weight", type=weight, default=1.0, metavar="W")
    parser.add_argument("--in-box", action="store_true", help="exclude clips that cannot reach the target")
    parser.add_argument(
        "--count",
        type=whole_parser(1, 100_000, "a number of clips"),
        default=8,
        metavar="N",
        help="number of clips to list",
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
        help="key presses for the behaviours of the stage, and when",
    )
    parser.add_argument("--json", action="store_true", help="print the result of the stage as JSON")
    parser.add_argument("--character", default="adult_woman", metavar="NAME|FILE")
    parser.add_argument(
        "--guard", type=Path, metavar="CAPTURE", help="guard clip; must start on guard with feet planted"
    )
    parser.add_argument("--seconds", type=seconds, default=60.0, metavar="S", help="duration in seconds")
    parser.add_argument("--head", nargs="+", metavar="NAME", help="target: mean of these trackers, or one bone")
    parser.add_argument("--port", type=port, default=PORT, metavar="N", help="port to receive trackers on")
    parser.add_argument(
        "--listen", default=LOOPBACK, metavar="ADDRESS", help="address to listen on (default: loopback)"
    )
    parser.add_argument(
        "--sender", nargs="+", default=[LOOPBACK], metavar="ADDRESS", help="accept packets only from this sender"
    )
    parser.add_argument("--replay", type=Path, metavar="FILE", help="replay recorded datagrams instead of the network")
    parser.add_argument("--stream", type=port, metavar="PORT", help="stream the character as VMC to this port")
    parser.add_argument("--stream-to", metavar="ADDRESS", help="address to stream to (default: this computer)")
    parser.add_argument(
        "--strike-every",
        type=number_parser(0.05, LONGEST_SECONDS, "a number of seconds"),
        metavar="S",
        help="strike automatically at this interval; otherwise type 'left punch'",
    )
    parser.add_argument(
        "--frozen",
        action="store_true",
        help="aim at the target's position when the strike starts, so that it can dodge",
    )
    parser.add_argument("--mirrored", action="store_true", help="also use every clip mirrored")
    parser.add_argument("--fast", action="store_true", help="run as fast as possible, not in real time")
    add_library_options(parser)


def add_formats_arguments(parser: ArgumentParser) -> None:
    """Add the output format."""
    parser.add_argument("--json", action="store_true", help="one object: formats, and load errors")


def add_render_arguments(parser: ArgumentParser) -> None:
    """Add the scene to draw, the kind of file and its size."""
    parser.add_argument("source", type=Path, metavar="PROJECT|SCENE|CAPTURE", help="a project, a scene or a capture")
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="PNG|MP4|FOLDER",
        help="output: an image, a video, or a new folder for one image per frame",
    )
    parser.add_argument(
        "--character",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME|FILE",
        help="characters to adapt the capture to; default: all bundled ones",
    )
    parser.add_argument(
        "--time", type=seconds, metavar="S", help="time of the still image in seconds (default: the middle)"
    )
    parser.add_argument("--camera", metavar="NAME", help="look through a saved camera of the project")
    parser.add_argument(
        "--size", type=size_parser(16, 8192), default=(1280, 720), metavar="WxH", help="pixels; 1280x720 by default"
    )
    parser.add_argument(
        "--film-rate",
        type=number_parser(1.0, 240.0, "a number of frames per second"),
        default=30.0,
        metavar="FPS",
        help="frame rate of a video (default: 30)",
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
        type=whole_parser(1, 100_000, "a number of runs"),
        default=9,
        metavar="N",
        help="number of runs; the median is reported (default: 9)",
    )
    parser.add_argument("--json", action="store_true", help="a list of {name, microseconds, best, paper, aim, ratio}")


def add_adaptation_options(parser: ArgumentParser) -> None:
    """Add the options of ``adapt`` and ``batch``: characters, constraints, output and import."""
    parser.formatter_class = RawDescriptionHelpFormatter
    parser.epilog = MOTION_SPACE_HELP + str(help_file())
    parser.add_argument(
        "--character",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME|FILE",
        help="bundled character names, character files, or 'actor' for the captured actor; default: all bundled",
    )
    parser.add_argument("--constraints", type=Path, metavar="FILE.json", help="file with constraints (and contacts)")
    grounds = parser.add_mutually_exclusive_group()
    grounds.add_argument("--ground", type=Path, metavar="FILE.json", help="ground file; default: flat at height 0")
    grounds.add_argument("--on-steps", action="store_true", help="stand on the steps on which the capture was recorded")
    parser.add_argument(
        "--place",
        nargs=4,
        action="append",
        default=[],
        metavar=("NAME", "X", "Y", "DEGREES"),
        help="position (metres) and rotation (degrees) of a character on the stage",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="output folder; created if missing")
    parser.add_argument("--format", default="bvh", metavar="SUFFIX", help="file format; default: bvh")
    parser.add_argument(
        "--at-origin",
        action="store_true",
        help="write each character where its own motion begins, not where it stands on the stage",
    )
    parser.add_argument(
        "--body-only",
        action="store_true",
        help="do not copy extra joints (fingers, props) from the capture",
    )
    parser.add_argument("--free-joints", action="store_true", help="disable joint limits")
    parser.add_argument("--exact", action="store_true", help="disable temporal smoothing")
    parser.add_argument("--through-body", action="store_true", help="disable arm self-collision")
    parser.add_argument("--all-frames", action="store_true", help="keep a calibration pose at the start of the file")
    parser.add_argument("--by-frame", action="store_true", help="include per-frame data in the report")
    parser.add_argument("--json", action="store_true", help="print the report instead of a table")
    add_output_options(parser)
    add_export_options(parser)
    add_import_options(parser)


def add_import_options(parser: ArgumentParser) -> None:
    """Add the options of reading: unit, up axis, frame rate, floor, reference pose, markers, body map."""
    group = parser.add_argument_group("reading", "Missing information is assumed; set it here to override.")
    group.add_argument("--unit", help="m, dm, cm, mm, inch, foot, cmu, unknown, or metres per unit")
    group.add_argument("--up-axis", metavar="AXIS", help="up axis of the file: X, Y, Z, --up-axis=-Y, or 'x y z'")
    group.add_argument("--frame-rate", type=frame_rate, metavar="FPS", help="frames per second")
    group.add_argument("--floor", type=metres, metavar="METRES", help="height of the ground")
    group.add_argument(
        "--reference",
        metavar="POSE",
        help="reference pose: 'zero' (all rotations zero) or the frame number of an upright pose",
    )
    group.add_argument("--marker-map", type=Path, metavar="FILE.json", help="marker map for a C3D file")
    group.add_argument(
        "--clean", action="store_true", help="remove spikes, left/right swaps and jitter from noisy motion"
    )
    group.add_argument("--undo-swaps", action="store_true", help="fix swapped marker labels of a C3D")
    group.add_argument(
        "--fill-gaps",
        type=number_parser(0.0, 60.0, "a number of seconds"),
        metavar="S",
        help="fill marker gaps up to this length with splines (default 0.15 s; 0 = off)",
    )
    group.add_argument(
        "--smooth",
        type=number_parser(0.01, 1000.0, "a number of Hz"),
        metavar="HZ",
        help="low-pass cut-off frequency for markers",
    )
    group.add_argument(
        "--body-map", type=Path, metavar="FILE.json", help="joint mapping by body part, as printed by `info --json`"
    )


def add_export_options(parser: ArgumentParser) -> None:
    """Add the options of writing: joint names, rest pose, range, frame rate and root."""
    group = parser.add_argument_group("writing")
    group.add_argument(
        "--joint-names",
        choices=tuple(joint_namings()),
        default="",
        help="joint naming convention; default for character files: original names",
    )
    group.add_argument(
        "--rest-pose",
        choices=tuple(REST_POSES),
        default="",
        help="rest pose of the skeleton: T-pose, or bind pose of the skin; default for characters: T-pose",
    )
    group.add_argument(
        "--range",
        type=seconds,
        nargs=2,
        metavar=("BEGIN", "END"),
        help="seconds that are written, of the motion or of the stage; all by default",
    )
    group.add_argument("--rate", type=frame_rate, metavar="FPS", help="output frame rate; default: that of the motion")
    group.add_argument(
        "--root",
        choices=tuple(filter(None, ROOT_CHOICES)),
        default="",
        help="root motion: add a root joint on the floor, or keep the hips in place; default: the hips carry it",
    )


def add_output_options(parser: ArgumentParser) -> None:
    """Add the option that lets files be replaced."""
    parser.add_argument("--overwrite", action="store_true", help="overwrite existing files")


def add_library_options(parser: ArgumentParser) -> None:
    """Add the folder of the motion library, and the option that adds the bundled strikes to it."""
    parser.add_argument(
        "--library",
        type=Path,
        default=library_folder(),
        metavar="DIR",
        help="library folder; default: the user's library",
    )
    parser.add_argument("--bundled", action="store_true", help="add the bundled strikes first")


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
