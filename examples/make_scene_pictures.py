"""Make the pictures of the bundled scenes that the library shows: python examples/make_scene_pictures.py [KEY...]."""

import sys

from studio.startup.process import prepare_process

prepare_process()

from studio.io.png import write_png  # noqa: E402
from studio.jobs.performances import stage_duration, stage_performances  # noqa: E402
from studio.library.scenes import SCENES  # noqa: E402
from studio.viewport.offscreen import render_frame  # noqa: E402

SIZE = (144, 144)
MOMENTS = {"fight_training": 2.0, "clap": 1.0, "handstand_and_cartwheel": 2.85, "one_target": 1.6}
"""Seconds of the stage that say most; of other scenes the middle one."""


def main(keys: list[str]) -> None:
    """Make the pictures of the scenes of these keys, or of all."""
    for scene in SCENES:
        if keys and scene.key not in keys:
            continue
        project = scene.make()
        results = {key: each.adapted for key, each in stage_performances(project).performances.items()}
        middle = max(stage_duration(project, key) for key in results) / 2
        scene.picture.parent.mkdir(exist_ok=True)
        write_png(scene.picture, render_frame(project, results, MOMENTS.get(scene.key, middle), SIZE))
        print(scene.picture.name, scene.picture.stat().st_size)


if __name__ == "__main__":
    main(sys.argv[1:])
