"""Write a table of foot slide, penetration and knee speed for every bundled capture on two bodies.

morpho-studio script examples/scripts/report_slides.py OUT.csv
"""

import csv
import sys

from studio import api

COLUMNS = ("slide_mm", "penetration_mm", "knee_speed_ratio", "acceleration_ratio")

with open(sys.argv[1], "w", newline="") as file:
    table = csv.writer(file)
    table.writerow(("capture", "body", *COLUMNS))
    for path in sorted(api.example_captures_folder().glob("*.bvh")):
        scene = api.new_scene()
        motion = scene.add_capture(path)
        for name in ("child", "giant"):
            scene.add_performer(scene.add_character(name), motion)
        for adapted in scene.adapt().values():
            table.writerow((path.stem, adapted.name, *(f"{adapted.report[key]:.2f}" for key in COLUMNS)))
