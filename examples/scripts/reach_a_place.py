"""Let the right hand of two bodies reach one place, and print by how much each misses it.

morpho-studio script examples/scripts/reach_a_place.py
"""

import numpy as np

from studio import api

scene = api.new_scene()
motion = scene.add_capture(api.example_captures_folder() / "reach_grasp.bvh")
for name in ("child", "giant"):
    scene.add_performer(scene.add_character(name), motion)

reach = api.PositionConstraint(
    motion,
    "Right hand at the shelf",
    api.BodyPoint(api.BodyPart.RIGHT_HAND),
    api.Chain(trunk=0.5),
    priority=0,
    activation=api.ActivationCurve(start=0.5, full=1.0, full_end=1.4, end=1.9),
    target=(0.4, -0.2, 1.3),
)
constraint = scene.add_constraint(reach)

for adapted in scene.adapt().values():
    residual = adapted.residuals[constraint][adapted.frame_at(1.2)]
    hand = np.round(adapted.place_of(reach.point)[adapted.frame_at(1.2)], 3)
    print(f"{adapted.name}: {1000.0 * residual:.1f} mm off, the wrist is at {hand} m")
