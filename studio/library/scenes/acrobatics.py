"""Handstand and cartwheel on bodies of all sizes (K05, section 10): hands bear the weight, on arms of any length."""

from dataclasses import replace

from studio.core.mesh import hand_shapes
from studio.core.stage.clip import Clip
from studio.core.stage.project import Performer, Project
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, source_motions, varied_characters

CARTWHEEL_SPACING_METRES = 2.2
"""Distance in metres from one body to the next; longer legs are ahead, in the direction of the cartwheel."""
CARTWHEEL_BLEND_SECONDS = 0.4
"""Seconds by which the cartwheel overlaps the end of the handstand."""


def handstand_and_cartwheel() -> Project:
    """Project of five bodies from the smallest to the largest, each with a handstand and then a cartwheel."""
    stuff = source_motions(handstand=("Handstand", "handstand"), cartwheel=("Cartwheel", "cartwheel"))
    characters = {key: replace(each, grip=hand_shapes.OPEN_GRIP) for key, each in varied_characters(5).items()}
    up, wheel = (stuff.captures[name].frame_count - 1 for name in ("handstand", "cartwheel"))
    clips = (
        Clip("handstand", 0, up, 0.0, "handstand"),
        Clip("cartwheel", 0, wheel, up / BUNDLED_FRAME_RATE - CARTWHEEL_BLEND_SECONDS, "cartwheel"),
    )
    keys = sorted(characters, key=lambda key: characters[key].morphology.leg_length)
    performers = {
        key: Performer(characters[key].name, key, clips, (0.0, CARTWHEEL_SPACING_METRES * (index - 2)))
        for index, key in enumerate(keys)
    }
    return Project(stuff.captures, stuff.motions, characters, performers, {}, stuff.contacts)
