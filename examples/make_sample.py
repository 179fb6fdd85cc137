"""Make what the studio shows before it can solve anything: python examples/make_sample.py [FOLDER].

The first bundled capture, read, and as the bundled characters perform it.
"""

import sys
from pathlib import Path

from studio.startup.process import prepare_process

prepare_process()

from studio.app import sample  # noqa: E402
from studio.core.normalized.normalize import detected_contacts  # noqa: E402
from studio.core.stage.project import Motion, Project  # noqa: E402
from studio.core.stage.staging import project_of_capture  # noqa: E402
from studio.io.adapted_file import write_adapted  # noqa: E402
from studio.io.importing import load_capture  # noqa: E402
from studio.io.project.character_file import bundled_characters  # noqa: E402
from studio.io.project.project_file import write_project  # noqa: E402
from studio.jobs.performances import adapted_performers  # noqa: E402


def main(arguments: list[str]) -> None:
    """Write the project and the motions into the folder, by default examples/sample."""
    folder = Path(arguments[0]) if arguments else Path(__file__).parent / "sample"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / sample.SAMPLE_PROJECT).unlink(missing_ok=True)  # a project file keeps what it was before
    capture = load_capture(sample.capture_file())
    contacts = detected_contacts(capture, sample.SAMPLE_MOTION_ID)
    kept = Project(
        captures={sample.SAMPLE_MOTION_ID: capture},
        motions={sample.SAMPLE_MOTION_ID: Motion(capture.name, sample.SAMPLE_MOTION_ID)},
        contacts={f"contact {index}": contact for index, contact in enumerate(contacts)},
    )
    write_project(folder / sample.SAMPLE_PROJECT, kept, sample.SAMPLE_MOTION_ID)
    project = project_of_capture(capture, contacts, bundled_characters(), sample.SAMPLE_MOTION_ID)
    write_adapted(folder / sample.SAMPLE_MOTIONS, adapted_performers(project))
    for path in (folder / sample.SAMPLE_PROJECT, folder / sample.SAMPLE_MOTIONS):
        print(f"{path.name}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
