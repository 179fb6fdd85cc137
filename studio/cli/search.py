"""``search``: which clip of the motion library hits a place best, for a character in a pose, and why."""

import math
from argparse import ArgumentParser, Namespace
from dataclasses import replace
from pathlib import Path

from studio.cli.adaptation import chosen_characters, ready_capture
from studio.cli.index import clip_record
from studio.cli.library_options import add_library_option
from studio.cli.printing import print_json, print_table
from studio.core.errors import StudioError
from studio.io.importing import GUESS_ALL
from studio.library.catalogue import Catalogue
from studio.library.clips import Kind, Limb
from studio.library.library import Library
from studio.library.searching import Asked, Result, find, place_before

LIMBS = {limb.words.replace(" ", "-"): limb for limb in Limb}
KINDS = {kind.value.replace(" ", "-"): kind for kind in Kind if kind is not Kind.NONE}


def add_arguments(parser: ArgumentParser) -> None:
    """The pose, the body, the place, what is wanted."""
    parser.add_argument("capture", type=Path, metavar="CAPTURE", help="the motion that the character is in")
    parser.add_argument("--frame", type=int, default=0, metavar="N", help="the frame of it from which to go on")
    parser.add_argument("--character", default="actor", metavar="NAME|FILE", help="by default the capture's own actor")
    parser.add_argument(
        "--target",
        type=float,
        nargs=3,
        required=True,
        metavar=("X", "Y", "Z"),
        help="metres forward and to the left of the root's place on the ground in that frame, and above the ground",
    )
    parser.add_argument("--limb", nargs="+", choices=LIMBS, default=[], help="only clips of these limbs")
    parser.add_argument("--kind", nargs="+", choices=KINDS, default=[], help="only clips of these kinds")
    parser.add_argument("--tag", nargs="+", default=[], metavar="TAG", help="only clips with one of these tags")
    parser.add_argument("--posture-weight", type=float, default=1.0, metavar="W")
    parser.add_argument("--reach-weight", type=float, default=1.0, metavar="W")
    parser.add_argument("--in-box", action="store_true", help="leave out clips that cannot come to the target at all")
    parser.add_argument("--count", type=int, default=8, metavar="N", help="how many clips are listed")
    add_library_option(parser)
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def run(arguments: Namespace) -> int:
    """Search and list."""
    with Catalogue(arguments.library) as catalogue:
        library = Library.of(catalogue)
    if not library.clips:
        raise StudioError(f"The library in '{arguments.library}' has no clips. Bring some in with `index FOLDER`.")
    found = find(library, asked_by(arguments), arguments.count)
    if arguments.json:
        print_json({"ok": True, "results": [result_record(each) for each in found]})
        return 0
    rows = [[each.clip.name, f"{each.start}", f"{each.hit}", f"{each.cost:.3f}", *each.reasons] for each in found]
    print_table(("clip", "from frame", "hit", "cost", "posture", "reach", "time"), rows)
    return 0


def asked_by(arguments: Namespace) -> Asked:
    """The arguments as the library takes them; StudioError for a frame there is not, or what is no number."""
    ready = ready_capture(arguments.capture, GUESS_ALL)
    motion, frame = ready.motion, arguments.frame
    if not 0 <= frame < motion.frame_count:
        raise StudioError(f"{arguments.capture.name} has frames 0 to {motion.frame_count - 1}, not {frame}.")
    own = arguments.character == "actor"
    body = ready.actor.morphology
    if not own:
        body = next(iter(chosen_characters([arguments.character]).values())).morphology
    weights = arguments.posture_weight, arguments.reach_weight
    if not all(map(math.isfinite, (*arguments.target, *weights))) or min(weights) < 0.0:
        raise StudioError("--target and weights have to be finite numbers, weights 0 or more.")
    pose = replace(motion, channels=motion.channels[frame : frame + 1])
    return Asked(
        pose,
        body,
        place_before(pose, body, arguments.target),
        limbs=[LIMBS[name] for name in arguments.limb],
        kinds=[KINDS[name] for name in arguments.kind],
        tags=arguments.tag,
        posture_weight=weights[0],
        reach_weight=weights[1],
        in_box=arguments.in_box,
    )


def result_record(found: Result) -> dict[str, object]:
    """A result as JSON has it."""
    numbers = {"posture_m": found.posture, "reach_m": found.reach, "cost": found.cost, "seconds_to_hit": found.seconds}
    return {
        **clip_record(found.clip),
        "from_frame": found.start,
        "hit_frame": found.hit,
        "turn": found.turn,
        **numbers,
        "reasons": list(found.reasons),
    }
