"""Let the right hand slide along a banister that rises, and keep the right foot aligned with the left one.

morpho-studio script examples/scripts/rail_and_parallel.py [OUT.bvh]
"""

import math
import sys

import numpy as np

from studio import api

scene = api.new_scene()
motion = scene.add_capture(api.example_captures_folder() / "walk_turn.bvh")
body = scene.add_performer(scene.add_character("child"), motion)
hand = api.BodyPoint(api.BodyPart.RIGHT_FOREARM, at_end=True)
left, right = api.BodyPoint(api.BodyPart.LEFT_FOOT), api.BodyPoint(api.BodyPart.RIGHT_FOOT)
before = scene.adapt(body)[body]
path = before.place_of(hand)[: before.frame_at(1.0)]
when = api.ActivationCurve(-1.0, 0.0, 0.9, 1.4)

rail = api.RailConstraint(
    motion, "Banister", hand, api.Chain(trunk=0.5), 0, when,
    centre=tuple(path.mean(axis=0) + np.array([0.0, 0.0, 0.1])), direction=tuple(path[-1] - path[0]),
)  # fmt: skip
aligned = api.ParallelConstraint(
    motion, "Feet aligned", right, api.Chain(end_segment=1.0), 1, when, other=left, cone=math.radians(5.0)
)
keys = [scene.add_constraint(each) for each in (rail, aligned)]
adapted = scene.adapt(body)[body]
full = (adapted.times >= 0.0) & (adapted.times <= 0.9)
off, angle = (float(np.nanmax(adapted.residuals[key][full])) for key in keys)
print(f"The hand is {1000.0 * off:.2f} mm off the banister, the feet {math.degrees(angle):.2f} degrees beyond 5.")
for out in sys.argv[1:]:
    scene.export(body, out)
