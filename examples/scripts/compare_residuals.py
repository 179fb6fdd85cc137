"""Swap the priorities of two constraints that cannot both be met, and see which one gives way.

morpho-studio script examples/scripts/compare_residuals.py
"""

from studio import api

scene = api.new_scene()
motion = scene.add_capture(api.example_captures_folder() / "reach_grasp.bvh")
body = scene.add_performer(scene.add_character("child"), motion)
when = api.ActivationCurve(0.5, 1.0, 1.4, 1.9)


def reach(name: str, part: api.BodyPart, target: tuple[float, float, float], priority: int) -> str:
    """Add a position constraint; its id."""
    point, chain = api.BodyPoint(part), api.Chain(trunk=0.5)
    return scene.add_constraint(api.PositionConstraint(motion, name, point, chain, priority, when, target=target))


high = reach("Right hand high", api.BodyPart.RIGHT_HAND, (0.2, -0.3, 1.15), priority=0)
low = reach("Left hand low", api.BodyPart.LEFT_HAND, (0.1, 0.3, 0.35), priority=1)

for title in ("right hand first", "left hand first"):
    adapted = scene.adapt(body)[body]
    frame = adapted.frame_at(1.2)
    told = {
        scene.project.constraints[key].name: f"{1000.0 * row[frame]:.1f} mm" for key, row in adapted.residuals.items()
    }
    print(title, told)
    with scene.undo_step("Swap priorities"):
        scene.change("constraints", high, priority=1)
        scene.change("constraints", low, priority=0)
