"""Make the pictures and the film of the documents: python examples/make_pictures.py [FOLDER] [NAME...]."""

import subprocess
import sys
from pathlib import Path

from pictured.bodies import bodies, priorities
from pictured.encode import write_film, write_picture
from pictured.figures import FIGURES, write_figure
from pictured.kick_film import FRAME_RATE, KickFilm
from pictured.scenes import fight, handstand
from pictured.shots import (
    behaviour,
    cameras,
    clip_speed,
    constrain,
    correction,
    curve_editor,
    dope_sheet,
    footage,
    import_report,
    keys,
    light_theme,
    markers,
    mirrored,
    onion_skins,
    poses,
    preferences,
    problem_table,
    rotate,
    skin_point,
    sliders,
    tilted_area,
    timeline,
    tour,
    trail_keys,
    turntable,
    weights,
    window,
)

from studio.startup import first_run

FILM_WIDTH = 640
STILLS = {
    "window": window,
    "fight": fight,
    "handstand": handstand,
    "constrain": constrain,
    "light_theme": light_theme,
    "onion_skins": onion_skins,
    "trail_keys": trail_keys,
    "cameras": cameras,
    "turntable": turntable,
    "rotate": rotate,
    "skin_point": skin_point,
    "tilted_area": tilted_area,
    "weights": weights,
    "mirrored": mirrored,
    "tour": tour,
    "poses": poses,
    "preferences": preferences,
    "problem_table": problem_table,
    "correction": correction,
    "timeline": timeline,
    "keys": keys,
    "dope_sheet": dope_sheet,
    "curve_editor": curve_editor,
    "clip_speed": clip_speed,
    "footage": footage,
    "import_report": import_report,
    "markers": markers,
    "sliders": sliders,
    "behaviour": behaviour,
    "method_bodies": bodies,
    "method_priorities": priorities,
}


def main(arguments: list[str]) -> None:
    """Make each picture into the folder, by default docs/pictures."""
    folder = Path(arguments[0]) if arguments else Path(__file__).parent.parent / "docs" / "pictures"
    names = arguments[1:] or [*STILLS, *FIGURES, "kick"]
    first_run.run()  # else the pictures would tell how long kernels compile
    for name in names:
        if name == "kick":
            write_film(folder / "kick.gif", KickFilm().images, FRAME_RATE, FILM_WIDTH)
        elif name in FIGURES:
            write_figure(folder / f"{name}.svg", FIGURES[name]())
        elif name == "light_theme" and len(names) > 1:  # colours are chosen before the window's modules are loaded
            subprocess.run([sys.executable, __file__, str(folder), name], check=True)
        else:
            write_picture(folder / f"{name}.png", STILLS[name]())


if __name__ == "__main__":
    main(sys.argv[1:])
