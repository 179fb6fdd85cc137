"""Make the characters that come with the studio: python examples/make_characters.py [FOLDER] [NAME...]."""

import json
import sys
from pathlib import Path

from studio.core.mannequin.physiques import BUNDLED_PHYSIQUES
from studio.core.mannequin.sculpt import make_mannequin
from studio.core.mesh.character import Character
from studio.io.project.character_file import write_character
from studio.resources_folder import resources_folder


def main(arguments: list[str]) -> None:
    """Write each character into the folder, by default the studio's own."""
    folder = Path(arguments[0]) if arguments else resources_folder() / "characters"
    folder.mkdir(parents=True, exist_ok=True)
    for name in arguments[1:] or BUNDLED_PHYSIQUES:
        label, colour, physique = BUNDLED_PHYSIQUES[name]
        skin = make_mannequin(physique)
        write_character(Character(label, colour, physique.morphology(), skin), folder / f"{name}.json")
        print(f"{label}: {physique.stature:.2f} m, {len(skin.vertices)} vertices")
    (folder / "index.json").write_text(json.dumps(list(BUNDLED_PHYSIQUES)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
