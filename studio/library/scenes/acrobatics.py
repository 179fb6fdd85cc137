"""A handstand and a cartwheel on all bodies (K05, section 10): hands bear the weight for a while, on arms of any
length.
"""

from dataclasses import replace

from studio.core.mesh import hand_shapes
from studio.core.stage.clip import Clip
from studio.core.stage.project import Performer, Project
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, bodies, material

WHEEL_SPACING = 2.2
"""Metres from one body to the next: they wheel that way, the longer legs ahead."""
JOINED = 0.4
"""Seconds by which the cartwheel fades in over the end of the handstand."""


def handstand_and_cartwheel() -> Project:
    """Five bodies from the smallest to the largest, each with one handstand and then one cartwheel."""
    stuff = material(handstand=("Handstand", "handstand"), cartwheel=("Cartwheel", "cartwheel"))
    characters = {key: replace(each, grip=hand_shapes.OPEN_GRIP) for key, each in bodies(5).items()}
    up, wheel = (stuff.captures[name].frame_count - 1 for name in ("handstand", "cartwheel"))
    clips = (
        Clip("handstand", 0, up, 0.0, "handstand"),
        Clip("cartwheel", 0, wheel, up / BUNDLED_FRAME_RATE - JOINED, "cartwheel"),
    )
    keys = sorted(characters, key=lambda key: characters[key].morphology.leg_length)
    performers = {
        key: Performer(characters[key].name, key, clips, (0.0, WHEEL_SPACING * (place - 2)))
        for place, key in enumerate(keys)
    }
    return Project(stuff.captures, stuff.motions, characters, performers, {}, stuff.contacts)
