"""A stage set without anyone arranging it: one capture, performed by some characters side by side."""

from collections.abc import Mapping

from studio.core.body.character import Character
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval
from studio.core.project import Motion, Performer, Project
from studio.core.stage.clip import Clip

SPACING = 1.15
"""Metres from one performer to the next."""


def side_by_side(characters: Mapping[str, Character], clips: tuple[Clip, ...] = ()) -> dict[str, Performer]:
    """One performer a character under the same id, in a row across the direction of the motion."""
    middle = (len(characters) - 1) / 2
    return {
        key: Performer(character.name, key, clips, (0.0, SPACING * (middle - place)))
        for place, (key, character) in enumerate(characters.items())
    }


def staged(
    capture: Capture, contacts: tuple[ContactInterval, ...], characters: Mapping[str, Character], motion_id: str
) -> Project:
    """A project in which every character performs the capture from where its motion begins to its last frame.

    ``contacts`` are those of ``motion_id``, the id that capture and motion get.
    """
    clips = (Clip(motion_id, capture.first_frame, capture.frame_count - 1, id=f"{motion_id} clip"),)
    return Project(
        captures={motion_id: capture},
        motions={motion_id: Motion(capture.name, motion_id)},
        characters=characters,
        performers=side_by_side(characters, clips),
        contacts={f"contact {place}": contact for place, contact in enumerate(contacts)},
    )
