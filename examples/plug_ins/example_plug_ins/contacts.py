"""``morpho-studio contacts CAPTURE``: how long each point of the body stands on the ground."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from studio import api


def add_arguments(parser: ArgumentParser) -> None:
    """The capture, and from how many seconds on a contact counts."""
    parser.add_argument("capture", type=Path)
    parser.add_argument("--at-least", type=float, default=0.0, metavar="SECONDS")


def run(arguments: Namespace) -> int:
    """Print a line for each point."""
    scene = api.new_scene()
    motion = scene.add_capture(arguments.capture)
    rate = scene.project.captures[scene.project.motions[motion].capture_id].frame_rate
    seconds: dict[str, float] = {}
    for contact in scene.project.contacts.values():
        lasts = (contact.last - contact.first + 1) / rate
        if lasts >= arguments.at_least:
            seconds[contact.point.words] = seconds.get(contact.point.words, 0.0) + lasts
    for point, total in seconds.items():
        print(f"{point}: {total:.2f} s")
    return 0


VERB = api.Verb("say how long each point of the body stands on the ground", add_arguments, run)
