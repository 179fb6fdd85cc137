"""Write the studio's scenes as projects: python examples/make_scenes.py FOLDER."""

import sys
from pathlib import Path

from studio.startup.process import prepare_process

prepare_process()

from studio.io.project.project_file import new_document_id, write_project  # noqa: E402
from studio.library.scenes import SCENES  # noqa: E402


def main(arguments: list[str]) -> None:
    """A project file a scene, and what to look for in it."""
    folder = Path(arguments[0]) if arguments else Path("scenes")
    folder.mkdir(parents=True, exist_ok=True)
    for scene in SCENES:
        path = folder / f"{scene.title.lower().replace(' ', '_')}.studio"
        write_project(path, scene.make(), new_document_id())
        print(f"{path}\n  {scene.text}")


if __name__ == "__main__":
    main(sys.argv[1:])
