"""Adapt a capture to three bodies and write a BVH file for each.

morpho-studio script examples/scripts/adapt_capture.py OUT_FOLDER [CAPTURE]
"""

import sys

from studio import api

out, *rest = sys.argv[1:]
capture = rest[0] if rest else api.example_captures_folder() / "walk_turn.bvh"

scene = api.new_scene()
motion = scene.add_capture(capture)
for place, name in enumerate(("child", "tall_man", "giant")):
    scene.add_performer(scene.add_character(name), motion, position=(0.0, 1.5 * place))

for path in scene.export_all(out, ".bvh"):
    print(path)
