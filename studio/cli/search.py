"""``search``: find the clips of the motion library that hit a target best, for a character in a pose, with reasons."""

from argparse import Namespace
from dataclasses import replace

from studio.cli.arguments import LIMB_WORDS, STRIKE_KINDS
from studio.cli.index import clip_record
from studio.cli.library_options import library_with_clips
from studio.cli.printing import print_json, print_table
from studio.core.errors import StudioError
from studio.io.importing import GUESS_ALL
from studio.jobs.adaptation import chosen_characters, ready_capture
from studio.library.searching import Result, StrikeQuery, position_ahead_of, search_strikes


def run(arguments: Namespace) -> int:
    """Search and print the results."""
    found = search_strikes(library_with_clips(arguments), query_of_arguments(arguments), arguments.count)
    if arguments.json:
        print_json({"ok": True, "results": [result_record(each) for each in found]})
        return 0
    rows = [[each.clip.name, f"{each.start}", f"{each.hit}", f"{each.cost:.3f}", *each.reasons] for each in found]
    print_table(("clip", "from frame", "hit", "cost", "posture", "reach", "time"), rows)
    return 0


def query_of_arguments(arguments: Namespace) -> StrikeQuery:
    """Query of the library from the arguments. Raises StudioError for a frame beyond the end."""
    ready = ready_capture(arguments.capture, GUESS_ALL)
    motion, frame = ready.motion, arguments.frame
    if not 0 <= frame < motion.frame_count:
        raise StudioError(f"{arguments.capture.name} has frames 0 to {motion.frame_count - 1}, not {frame}.")
    own = arguments.character == "actor"
    body = ready.actor.morphology
    if not own:
        body = next(iter(chosen_characters([arguments.character]).values())).morphology
    pose = replace(motion, channels=motion.channels[frame : frame + 1])
    return StrikeQuery(
        pose,
        body,
        position_ahead_of(pose, body, arguments.target),
        limbs=[LIMB_WORDS[name] for name in arguments.limb],
        kinds=[STRIKE_KINDS[name] for name in arguments.kind],
        tags=arguments.tag,
        posture_weight=arguments.posture_weight,
        reach_weight=arguments.reach_weight,
        in_box=arguments.in_box,
    )


def result_record(found: Result) -> dict[str, object]:
    """Record of a result for JSON."""
    numbers = {
        "posture_m": found.posture,
        "reach_m": found.reach,
        "cost": found.cost,
        "seconds_to_hit": found.seconds_to_hit,
    }
    return {
        **clip_record(found.clip),
        "from_frame": found.start,
        "hit_frame": found.hit,
        "turn": found.turn,
        **numbers,
        "reasons": list(found.reasons),
    }
