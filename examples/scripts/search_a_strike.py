"""Search the bundled strikes for the one that hits a place best, for two bodies.

morpho-studio script examples/scripts/search_a_strike.py
"""

from studio import api

TARGET = (0.8, 0.0, 1.3)  # metres ahead of the performer, to its left, above the ground

for name in ("child", "giant"):
    scene = api.new_scene()
    motion = scene.add_capture(api.example_captures_folder() / "straight_punch.bvh")
    body = scene.add_performer(scene.add_character(name), motion)
    for result in scene.search(body, 0.0, TARGET, count=3):
        print(f"{name}: {result.clip.name}: {', '.join(result.reasons)}")
