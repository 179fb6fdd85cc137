"""Films of captures on characters beside their source, as sheets to be looked at: a row a body, twelve frames each.

python examples/make_films.py FOLDER [CAPTURE...] [--character NAME ...]

Writes CAPTURE.png and CAPTURE.mp4 to the folder, by default of the bundled captures and of fourteen scenes of the
captures beside the checkout, where they are there. The first row is the capture as it was taken, on a figure with its
actor's measures.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from studio.startup.process import prepare_process  # noqa: E402

prepare_process()

from studio.core.solver.source import source_motion  # noqa: E402
from studio.core.stage.staging import project_of_capture  # noqa: E402
from studio.io.importing import GUESS_ALL  # noqa: E402
from studio.io.media.film import write_film  # noqa: E402
from studio.io.png import write_png  # noqa: E402
from studio.io.project.character_file import actor_character  # noqa: E402
from studio.jobs.adaptation import ADAPTED_MOTION_ID, chosen_characters, ready_capture  # noqa: E402
from studio.jobs.performances import stage_duration, stage_performances  # noqa: E402
from studio.viewport.offscreen import render_frame  # noqa: E402

SHARED = ROOT.parent / "shared" / "captures" / "bvh"
SCENES = (
    "varied/accad_female1_B03_Walk1", "varied/accad_female1_B15_WalkTurnAround180", "varied/accad_female1_C03_Run",
    "varied/accad_female1_C20_RunToJumpToWalk", "varied/accad_female1_A05_PickUpBox",
    "varied/accad_female1_A08_CrouchToLie", "varied/accad_female1_A11_CrawlForward",
    "varied/accad_female1_D6_CartWheel", "varied/mass_backflip", "varied/mass_pirouette", "varied/cmu_salsa_10",
    "strikes/accad_male2_E1_JabLeft", "strikes/accad_male2_G2_FrontKick", "strikes/accad_male2_G7_Capoeira",
)  # fmt: skip
SOURCE, COLUMNS, TILE, RATE = "source", 12, (176, 208), 12


def main() -> None:
    """Make a sheet and a film of each capture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("captures", type=Path, nargs="*")
    parser.add_argument("--character", nargs="+", default=["child", "giant", "stocky_man"])
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    bundled = sorted((ROOT / "examples" / "captures").glob("*.bvh"))
    for path in given.captures or [*bundled, *(path for name in SCENES if (path := SHARED / f"{name}.bvh").is_file())]:
        columns = list(pictures(path, given.character))
        write_png(given.folder / f"{path.stem}.png", np.concatenate(columns, axis=1))
        size = TILE[0], TILE[1] * (1 + len(given.character))
        write_film(given.folder / f"{path.stem}.mp4", columns, size, RATE)
        print(given.folder / f"{path.stem}.png", flush=True)


def pictures(path: Path, names: list[str]) -> Iterator[NDArray[np.uint8]]:
    """Columns (height, width, 4) of RGBA bytes: the source over the characters, each at one of twelve moments."""
    ready = ready_capture(path, GUESS_ALL)
    actor = actor_character("Source", ready.actor.morphology)
    project = project_of_capture(
        ready.capture, ready.contacts, {SOURCE: actor, **chosen_characters(names)}, ADAPTED_MOTION_ID
    )
    results = {key: each.adapted for key, each in stage_performances(project).performances.items()}
    first = results[SOURCE].first_frame
    results[SOURCE] = source_motion(ready.motion, ready.actor).frames(first, first + results[SOURCE].frame_count - 1)
    alone = {key: replace(project, performers={key: project.performers[key]}) for key in project.performers}
    for time in np.linspace(0.0, stage_duration(project, SOURCE), COLUMNS):
        shown = (render_frame(alone[key], {key: results[key]}, float(time), TILE) for key in alone)
        yield np.concatenate(list(shown), axis=0)


if __name__ == "__main__":
    main()
