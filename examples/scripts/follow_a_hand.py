"""Let the left hand of one performer stay on the right shoulder of another.

morpho-studio script examples/scripts/follow_a_hand.py OUT_FOLDER
"""

import sys

import numpy as np

from studio import api

scene = api.new_scene()
motion = scene.add_capture(api.example_captures_folder() / "reach_grasp.bvh")
leader = scene.add_performer(scene.add_character("giant"), motion)
follower = scene.add_performer(scene.add_character("adult_woman"), motion, position=(-0.1, -0.6))

shoulder = api.BodyPoint(api.BodyPart.RIGHT_UPPER_ARM)
hand = api.PositionConstraint(
    motion,
    "Left hand on the shoulder",
    api.BodyPoint(api.BodyPart.LEFT_HAND),
    api.Chain(trunk=0.5, root=0.3),
    priority=0,
    activation=api.ActivationCurve(0.2, 0.6, 1.6, 2.0),
    scope=api.Scope(performer_id=follower),
    target=api.FollowPerformer(leader, shoulder),
)
scene.add_constraint(hand)

adapted = scene.adapt()
frame = adapted[follower].frame_at(1.0)
gap = adapted[follower].place_of(hand.point)[frame] - adapted[leader].place_of(shoulder)[frame]
print(f"{1000.0 * np.linalg.norm(gap):.1f} mm between hand and shoulder")
scene.export_all(sys.argv[1])
