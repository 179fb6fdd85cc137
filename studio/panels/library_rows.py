"""Rows of the library as plain values: titles, entities of the project, and scenes that can be opened."""

import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from studio.core.body.growth import KeyedProportions
from studio.core.constraints.base import Constraint
from studio.core.mesh.character import Character
from studio.core.stage.project import GROUND_ID, Project
from studio.document import colours
from studio.document.length_units import length_text
from studio.engine.point_names import point_words
from studio.library.scenes import SCENES

Item = tuple[str, str]
BUNDLED_SCENE, SAVED_PROJECT = "scenes", "projects"
"""Pseudo-collections in the items of scenes: the id is the key of a bundled scene, or the path of a project file."""
SCENE_COLLECTIONS = (BUNDLED_SCENE, SAVED_PROJECT)


@dataclass(frozen=True)
class LibraryRow:
    """Row of the library. A title or hint has no ``item``."""

    text: str
    detail: str = ""
    item: Item | None = None
    colour: str | None = None
    round_mark: bool = True
    shown: bool | None = None
    """True if the character is visible; None if the row has no visibility."""
    hint: bool = False
    strong: bool = False
    tags: tuple[str, ...] = ()
    description: str = ""

    @property
    def words(self) -> str:
        """Text that the search matches: name and tags."""
        return " ".join((self.text, *self.tags))


def rows_of(
    project: Project, motion_id: str | None, search: str = "", scenes: Sequence[LibraryRow] = ()
) -> list[LibraryRow]:
    """All rows in order: entities of the project, constraints of the motion ``motion_id``, and ``scenes`` last.

    With ``search``, only rows whose name or tags contain each of its words, and the titles above them.
    """
    sections = (
        ("Captures", _captures(project, motion_id), "Drop a capture here"),
        ("Characters", _bodies(project), "Bundled characters are added with the first capture"),
        ("Constraints", _constraints(project, motion_id), "Pick a joint and press C to add one"),
        ("Stage", _stage(project), ""),
        *([("Scenes", list(scenes), "")] if scenes else []),
    )
    words = _comparable(search).split()
    if not words:
        return [row for title, rows, hint in sections for row in (LibraryRow(title), *(rows or [_hint(hint)]))]
    found = [(title, [row for row in rows if _holds(row.words, words)]) for title, rows, _ in sections]
    hits = [row for title, rows in found if rows for row in (LibraryRow(title), *rows)]
    return hits or [_hint(f"No name or tag contains '{search.strip()}'. Press Esc in the field to list everything.")]


def scene_rows(recent: Iterable[Path]) -> list[LibraryRow]:
    """Rows of the ``recent`` project files and of all bundled scenes."""
    saved = [LibraryRow(path.name, str(path.parent), (SAVED_PROJECT, str(path))) for path in recent]
    bundled = [
        LibraryRow(
            scene.title, ", ".join(scene.tags), (BUNDLED_SCENE, scene.key), tags=scene.tags, description=scene.text
        )
        for scene in SCENES
    ]
    return saved + bundled


def _hint(text: str) -> LibraryRow:
    return LibraryRow(text, hint=True)


def _holds(name: str, words: list[str]) -> bool:
    text = _comparable(name)
    return all(word in text for word in words)


def _comparable(text: str) -> str:
    """Text in lower case with composed accents, since file names of macOS have decomposed ones."""
    return unicodedata.normalize("NFKC", text).casefold()


def _captures(project: Project, motion_id: str | None) -> list[LibraryRow]:
    motion = project.motions.get(motion_id or "")
    tags = {each.capture_id: each.tags for each in project.motions.values()}
    return [
        LibraryRow(
            capture.name,
            _tagged(f"{capture.duration:.1f} s · {capture.frame_rate:.4g} fps", tags.get(key, ())),
            ("captures", key),
            strong=motion is not None and key == motion.capture_id,
            tags=tags.get(key, ()),
        )
        for key, capture in project.captures.items()
    ]


def _bodies(project: Project) -> list[LibraryRow]:
    rows = []
    for key, performer in project.performers.items():
        character = project.characters[performer.character_id]
        rows.append(
            LibraryRow(
                performer.name,
                _tagged(_stature(character), character.tags),
                ("performers", key),
                character.colour,
                shown=performer.visible,
                tags=character.tags,
            )
        )
    on_stage = {performer.character_id for performer in project.performers.values()}
    for key, character in project.characters.items():
        if key not in on_stage:
            rows.append(
                LibraryRow(
                    character.name,
                    _tagged(_stature(character), character.tags),
                    ("characters", key),
                    character.colour,
                    shown=False,
                    tags=character.tags,
                )
            )
    return rows


def _tagged(detail: str, tags: tuple[str, ...]) -> str:
    return " · ".join((detail, ", ".join(tags))) if tags else detail


def _stature(character: Character) -> str:
    """Stature as text, ``1.66 m``, or ``1.20 – 1.94 m`` if it is keyed."""
    keyed = character.proportions
    if not isinstance(keyed, KeyedProportions):
        return length_text(character.morphology.stature, "m", 2)
    statures = [each.applied_to(character.build).stature for each in keyed.values]
    least = length_text(min(statures), "m", 2).split()[0]
    return f"{least} – {length_text(max(statures), 'm', 2)}"


def _constraints(project: Project, motion_id: str | None) -> list[LibraryRow]:
    if motion_id is None:
        return []
    places = project.places_of(motion_id)
    return [
        LibraryRow(
            f"{places[key]} · {constraint.name}",
            _point(constraint) if constraint.enabled else "off",
            ("constraints", key),
            colours.kind_colour(constraint.kind),
            round_mark=False,
        )
        for key, constraint in project.constraints_of(motion_id).items()
    ]


def _point(constraint: Constraint) -> str:
    """Name of the constrained point; empty if the constraint's name contains it."""
    words = constraint.shown.about or point_words(constraint.point)
    return "" if words in constraint.name.lower() else words


def _stage(project: Project) -> list[LibraryRow]:
    props = [LibraryRow(prop.name, "prop", ("props", key)) for key, prop in project.props.items()]
    ground = project.ground
    words = length_text(ground.height, "m", 2) if ground.is_level else ground.kind.replace("_", " ")
    return [LibraryRow("Ground", words, ("grounds", GROUND_ID)), *props]
