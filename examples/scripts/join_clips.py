"""Play a kick after a walk, twice as slowly, in a mirror, and save the project.

morpho-studio script examples/scripts/join_clips.py OUT.studio
"""

import sys

from studio import api

scene = api.new_scene()
walk = scene.add_capture(api.example_captures_folder() / "walk_turn.bvh")
kick = scene.add_capture(api.example_captures_folder() / "front_kick.bvh")
body = scene.add_performer(scene.add_character("tall_man"))

capture = scene.project.captures[scene.project.motions[kick].capture_id]
slow_kick = api.Clip(kick, 0, capture.frame_count - 1, start=4.0, id="slow kick", speed=0.5, mirrored=True)
scene.play(body, walk, slow_kick)

times = scene.adapt(body)[body].times
print(f"The row lasts {times[-1] - times[0]:.2f} s.")
scene.save(sys.argv[1])
