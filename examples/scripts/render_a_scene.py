"""Draw a bundled scene, or a project file, as a picture.

morpho-studio script examples/scripts/render_a_scene.py OUT.png [SCENE_OR_PROJECT [SECONDS]]
"""

import sys

from studio import api

out, *rest = sys.argv[1:]
scene = api.open_scene(rest[0] if rest else "one-walk-on-five-bodies")
scene.render(out, float(rest[1]) if len(rest) > 1 else None, size=(640, 360))
