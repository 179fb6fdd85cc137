"""Keep the toes that leave the ground first down for a fifth of a second longer, compare, and undo it.

morpho-studio script examples/scripts/plant_a_foot.py
"""

import numpy as np

from studio import api

TOES = {api.ContactPoint.LEFT_TOE: api.BodyPart.LEFT_TOE, api.ContactPoint.RIGHT_TOE: api.BodyPart.RIGHT_TOE}

scene = api.new_scene()
motion = scene.add_capture(api.example_captures_folder() / "front_kick.bvh")
body = scene.add_performer(scene.add_character("adult_woman"), motion)

key, contact = min(
    ((key, each) for key, each in scene.project.contacts.items() if each.point in TOES), key=lambda pair: pair[1].last
)
before = scene.adapt(body)[body]
scene.change("contacts", key, last=contact.last + round(0.2 * before.frame_rate))
after = scene.adapt(body)[body]
scene.undo()

toes = api.BodyPoint(TOES[contact.point])
moved = np.linalg.norm(after.place_of(toes) - before.place_of(toes), axis=1).max()
print(f"The {contact.point.words} moves by {100.0 * moved:.1f} cm at most.")
