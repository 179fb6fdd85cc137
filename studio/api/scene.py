"""Scene that a script edits: a project in a document, so that every change can be undone."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path
from types import MappingProxyType
from typing import Any

from studio.api.results import Adapted
from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.base import Constraint, Vector
from studio.core.errors import StudioError
from studio.core.mesh.character import Character
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.clip import Clip
from studio.core.stage.project import Entity, Motion, Performer, Project, new_id
from studio.document.correction_edits import set_pose
from studio.document.edited_project import EditedProject
from studio.io.export import write_take
from studio.io.export_options import ExportOptions
from studio.io.importing import GUESS_ALL, ImportOptions, known_of_motion, read_capture
from studio.io.plug_ins import load_registered
from studio.io.png import write_png
from studio.io.project.project_file import new_document_id, write_project
from studio.io.staged_export import file_name, take_of_performer
from studio.jobs.adaptation import chosen_characters, make_folder
from studio.jobs.bundled_scenes import open_project
from studio.jobs.performances import stage_performances
from studio.library.catalogue import Catalogue
from studio.library.clip_labels import Kind, Limb
from studio.library.indexing import bundled_library
from studio.library.library import Library
from studio.library.searching import Result, StrikeQuery, position_ahead_of, search_strikes

DEFAULT_EXPORT = ExportOptions()
"""Export options with which the take's own values are kept."""


class Scene:
    """Scene with captures, characters, performers, constraints and contacts, which a script edits by id."""

    def __init__(self, document: EditedProject | None = None) -> None:
        """Edit ``document``, for example that of an open window, or a new one."""
        self.document = document or EditedProject(Project())

    @property
    def project(self) -> Project:
        """All entities of the scene at present, as an immutable value."""
        return self.document.project

    # Edits

    @contextmanager
    def undo_step(self, text: str) -> Iterator[None]:
        """Context in which all edits are one undo step; an exception reverts them."""
        with self.document.group(text):
            yield

    def undo(self) -> None:
        """Undo the last step."""
        self.document.undo_stack.undo()

    def redo(self) -> None:
        """Redo the last undone step."""
        self.document.undo_stack.redo()

    def add(self, collection: str, entity: Entity) -> str:
        """Add an entity, for example a ``Prop`` to ``props``, and return its id.

        Raises StudioError if it conflicts with others.
        """
        return self.document.add(collection, entity, f"Add to {collection}")

    def change(self, collection: str, entity_id: str, **fields: Any) -> None:
        """Set fields of an entity, for example ``change("performers", child, position=(1, 0))``."""
        old = self.document.project.get(collection, entity_id)
        if old is None:
            raise StudioError(f"There is no '{entity_id}' among the {collection}.")
        self.document.replace(collection, entity_id, replace(old, **fields), f"Change {', '.join(fields)}")

    def remove(self, collection: str, entity_id: str) -> None:
        """Remove an entity and its dependents."""
        self.document.remove(collection, entity_id, f"Remove from {collection}")

    def add_capture(self, path: Path | str, options: ImportOptions = GUESS_ALL) -> str:
        """Import a capture with its contacts, constraints and labels, and return the id of its motion.

        Contacts are detected if the file has none. Raises StudioError for a file that cannot be read.
        """
        read = read_capture(path, options)
        motion_id = new_id()
        known = known_of_motion(read.capture, read.annotations, motion_id)
        text = f"Import {Path(path).name}"
        with self.document.group(text):
            capture_id = self.document.add("captures", read.capture, text)
            self.document.put_all("motions", {motion_id: Motion(read.capture.name, capture_id)}, text)
            self.document.add_all("contacts", known.contacts or (), text)
            self.document.add_all("constraints", known.constraints, text)
            self.document.add_all("labels", known.labels, text)
        return motion_id

    def add_character(self, character: Character | Path | str) -> str:
        """Add a character and return its id: an object, a bundled one by name, or a file (glTF, VRM, FBX, ...)."""
        if not isinstance(character, Character):
            [character] = chosen_characters([str(character)]).values()
        return self.document.add("characters", character, f"Add {character.name}")

    def add_performer(
        self,
        character_id: str,
        motion_id: str | None = None,
        *,
        position: tuple[float, float] = (0.0, 0.0),
        heading: float = 0.0,
    ) -> str:
        """Put a character on the stage, with a clip of the whole motion if one is given, and return
        the performer's id.
        """
        character = self.project.characters.get(character_id)
        if character is None:
            raise StudioError(f"There is no character '{character_id}'. Add it first.")
        clips = () if motion_id is None else (self._whole_clip(motion_id),)
        performer = Performer(character.name, character_id, clips, position, heading)
        return self.document.add("performers", performer, f"Add {character.name}")

    def play(self, performer_id: str, *clips: Clip | str) -> None:
        """Set the row of clips of a performer; the id of a motion stands for a clip of all its frames."""
        row = tuple(self._whole_clip(each) if isinstance(each, str) else each for each in clips)
        self.change("performers", performer_id, clips=row)

    def _whole_clip(self, motion_id: str) -> Clip:
        motion = self.project.motions.get(motion_id)
        if motion is None:
            raise StudioError(f"There is no motion '{motion_id}'. Import its capture first.")
        capture = self.project.captures[motion.capture_id]
        return Clip(motion_id, capture.first_frame, capture.frame_count - 1, id=new_id())

    def add_constraint(self, constraint: Constraint) -> str:
        """Add a constraint and return its id."""
        return self.document.add("constraints", constraint, f"Add {constraint.name}")

    def add_contact(self, motion_id: str, point: ContactPoint | str, first: int, last: int) -> str:
        """Add a ground contact of a point from frame ``first`` to ``last`` of a motion, and return its id."""
        contact = ContactInterval(motion_id, ContactPoint(point), first, last)
        return self.document.add("contacts", contact, f"Add contact of {contact.point.words}")

    def correct_pose(
        self,
        performer_id: str,
        time: float,
        turns: Mapping[BodyPart | str, Vector] = MappingProxyType({}),
        hips: Vector | None = None,
        *,
        above: bool = False,
    ) -> str:
        """Set a key of a manual correction of a performer at ``time``, in seconds of the stage; return the id of the
        correction. ``turns`` has rotation vectors (radians, in the axes of the part), ``hips`` a displacement in leg
        lengths (ahead, left, up). A new correction fades in and out within half a second; one that is active at that
        time gets another key. With ``above`` it is applied after the constraints.
        """
        if performer_id not in self.project.performers:
            raise StudioError(f"There is no performer '{performer_id}'. Add it first.")
        try:
            asked = {BodyPart(part): turn for part, turn in turns.items()}
        except ValueError as error:
            raise StudioError(f"{error}. The parts are {', '.join(BodyPart)}.") from error
        with self.undo_step("Correct pose"):
            key = set_pose(self.document, performer_id, time, asked, hips)
            if self.project.corrections[key].above != above:
                self.change("corrections", key, above=above)
        return key

    # Results

    def adapt(self, *performer_ids: str) -> dict[str, Adapted]:
        """Adapt the whole stage and return these performers, by default all visible ones with clips.

        Raises StudioError if one of them cannot be adapted.
        """
        project = self.project
        staged = stage_performances(project)
        for key in performer_ids or staged.failures:
            if key in staged.failures:
                raise StudioError(f"{project.performers[key].name} could not be adapted: {staged.failures[key]}")
            if key not in staged.performances:
                raise StudioError(f"'{key}' is not a visible performer with a clip.")
        chosen = performer_ids or tuple(staged.performances)
        return {key: Adapted(project, key, staged.performances[key]) for key in chosen}

    def export(self, performer_id: str, path: Path | str, options: ExportOptions = DEFAULT_EXPORT) -> None:
        """Write the motion of a performer to a file, in the format of its suffix."""
        self._write(self.adapt(performer_id)[performer_id], Path(path), options)

    def export_all(
        self, folder: Path | str, suffix: str = ".bvh", options: ExportOptions = DEFAULT_EXPORT
    ) -> list[Path]:
        """Write a file for every visible performer with clips; return the files."""
        make_folder(Path(folder))
        adapted = self.adapt()
        paths = [Path(folder) / file_name(self.project, key, suffix) for key in adapted]
        for each, path in zip(adapted.values(), paths, strict=True):
            self._write(each, path, options)
        return paths

    def _write(self, adapted: Adapted, path: Path, options: ExportOptions) -> None:
        along = options.carries(path)
        take = take_of_performer(adapted.project, adapted.performer_id, adapted.performance, along=along)
        write_take(options.applied_to(take, path), path)

    def render(self, path: Path | str, time: float | None = None, size: tuple[int, int] = (1280, 720)) -> None:
        """Draw the stage at ``time``, in seconds, by default half-way, as a PNG of ``size`` pixels."""
        found = entry_points(group="morpho_studio.render", name="picture")
        if not found:
            raise StudioError("Nothing that draws is installed. Install Morpho Studio with `pip install -e .` first.")
        project = self.project
        results = {key: each.performance.adapted for key, each in self.adapt().items()}
        if not results:
            raise StudioError("No performer of the stage has a motion: there is nothing to draw.")
        if time is None:
            time = max(timing_of(project, project.performers[key]).end for key in results) / 2
        write_png(Path(path), next(iter(found)).load()(project, results, time, size))

    def search(
        self,
        performer_id: str,
        time: float,
        target: tuple[float, float, float],
        *,
        library: Path | str | None = None,
        limbs: Sequence[Limb] = (),
        kinds: Sequence[Kind] = (),
        count: int = 8,
    ) -> list[Result]:
        """Clips of a library that hit a target best, from the performer's pose at ``time``, the best first.

        ``target`` is metres ahead of the performer, to its left, and above the ground; ``library`` the folder of an
        indexed library, by default the bundled strikes.
        """
        [adapted] = self.adapt(performer_id).values()
        composite = adapted.performance.composite
        frame = composite.timing.first + adapted.frame_at(time)
        pose = replace(composite.motion, channels=composite.motion.channels[frame : frame + 1])
        body = adapted.performance.adapted.morphology
        asked = StrikeQuery(pose, body, position_ahead_of(pose, body, target), limbs=limbs, kinds=kinds)
        return search_strikes(_library(library), asked, count)

    def save(self, path: Path | str) -> None:
        """Write the project to a ``.studio`` file."""
        write_project(Path(path), self.project, new_document_id())


def new_scene() -> Scene:
    """Empty scene."""
    load_registered()
    return Scene()


def open_scene(source: Path | str) -> Scene:
    """Scene in a ``.studio`` file, or a bundled scene by name, such as ``fight-training``."""
    load_registered()
    return Scene(EditedProject(open_project(Path(source))))


def _library(folder: Path | str | None) -> Library:
    if folder is None:
        return bundled_library()
    with Catalogue(Path(folder)) as catalogue:
        found = Library.of(catalogue)
    if not found.clips:
        raise StudioError(f"The library in '{folder}' has no clips. Add captures with `index FOLDER`.")
    return found
