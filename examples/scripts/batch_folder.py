"""Adapt every BVH of a folder to one body; a file that cannot be read does not stop the others.

morpho-studio script examples/scripts/batch_folder.py FOLDER OUT_FOLDER [CHARACTER]
"""

import sys
from pathlib import Path

from studio import api

folder, out, *rest = sys.argv[1:]
character = rest[0] if rest else "child"

for path in sorted(Path(folder).glob("*.bvh")):
    scene = api.new_scene()
    try:
        motion = scene.add_capture(path)
        scene.add_performer(scene.add_character(character), motion)
        written = scene.export_all(Path(out), ".bvh")
    except api.StudioError as error:
        print(f"{path.name}: {error}")
        continue
    print(*written)
