"""Parts of the bundled scenes: captures as motions, bodies of other proportions, activations and points of bodies."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Proportions
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import BodyPoint
from studio.core.curves.activation import ActivationCurve, EaseShape
from studio.core.mesh.character import Character
from studio.core.normalized.normalize import detected_contacts
from studio.core.stage.project import Motion
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.resources_folder import example_captures_folder

BUNDLED_FRAME_RATE = 60.0
"""Frame rate of the bundled captures."""
CHEST_POINT = BodyPoint(BodyPart.THORAX)
HEAD_TOP_POINT = BodyPoint(BodyPart.HEAD, at_end=True)


@dataclass(frozen=True, eq=False)
class SourceMotions:
    """Captures by id, the motions made of them, and the contacts of each motion."""

    captures: Mapping[str, Capture]
    motions: Mapping[str, Motion]
    contacts: Mapping[str, ContactInterval]


def source_motions(**names: tuple[str, str]) -> SourceMotions:
    """Motions by id (the keywords), each from ``(name, file)`` of a bundled capture; one file may give
    several motions.
    """
    files = dict.fromkeys(file for _, file in names.values())
    captures = {file: load_capture(example_captures_folder() / f"{file}.bvh") for file in files}
    contacts = {
        f"{key} {index}": contact
        for key, (_, file) in names.items()
        for index, contact in enumerate(detected_contacts(captures[file], key))
    }
    return SourceMotions(captures, {key: Motion(name, file) for key, (name, file) in names.items()}, contacts)


def varied_characters(count: int) -> dict[str, Character]:
    """``count`` characters of different builds: the bundled ones, then the same with other proportions."""
    found = dict(bundled_characters())
    others = (
        Proportions(stature=0.93, thighs=1.06, shanks=1.06),
        Proportions(stature=1.04, upper_arms=1.08, forearms=1.08),
        Proportions(stature=0.97, thighs=0.94, shanks=0.94),
    )
    for index, proportions in enumerate(others):
        key, character = list(bundled_characters().items())[index]
        found[f"{key} {index}"] = replace(character, name=f"{character.name} {index + 2}", proportions=proportions)
    return dict(list(found.items())[:count])


def hit_activation(frame: int, ease: int = 9) -> ActivationCurve:
    """Activation that is full in ``frame`` only and fades in and out over ``ease`` frames: a blow touches
    for a moment.
    """
    first, last = frame - 0.5, frame + 0.5
    return ActivationCurve(
        (first - ease) / BUNDLED_FRAME_RATE,
        first / BUNDLED_FRAME_RATE,
        last / BUNDLED_FRAME_RATE,
        (last + ease) / BUNDLED_FRAME_RATE,
        EaseShape.SMOOTH,
    )


def held_activation(frame: int, ease: int = 14, hold: int = 3) -> ActivationCurve:
    """Activation that is full from ``hold`` frames before ``frame`` to ``hold`` after, and fades over
    ``ease`` frames.
    """
    first, last = frame - hold, frame + hold
    return ActivationCurve(
        (first - ease) / BUNDLED_FRAME_RATE,
        first / BUNDLED_FRAME_RATE,
        last / BUNDLED_FRAME_RATE,
        (last + ease) / BUNDLED_FRAME_RATE,
    )
