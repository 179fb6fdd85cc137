"""Rows of the library: heads, captures, bodies and constraints of a project, as plain values."""

import unicodedata
from dataclasses import dataclass

from studio.core.body.growth import KeyedProportions
from studio.core.constraints.base import Constraint
from studio.core.mesh.character import Character
from studio.core.stage.project import GROUND_ID, Project
from studio.document import colours
from studio.engine.point_names import point_words

Item = tuple[str, str]


@dataclass(frozen=True)
class LibraryRow:
    """One row. A head has no item; a hint is a head in sentence case."""

    text: str
    detail: str = ""
    item: Item | None = None
    colour: str | None = None
    round_mark: bool = True
    shown: bool | None = None
    """True if the body is on the stage; None where nothing can be shown or hidden."""
    hint: bool = False
    strong: bool = False


def rows_of(project: Project, motion_id: str | None, search: str = "") -> list[LibraryRow]:
    """All rows in their order; constraints are those of ``motion_id``.

    With a ``search``, only rows whose names contain each of its words, and the heads above them.
    """
    sections = (
        ("Captures", _captures(project, motion_id), "Drop a capture here"),
        ("Characters", _bodies(project), "The bundled characters come with the first capture"),
        ("Constraints", _constraints(project, motion_id), "Pick a joint and press C to add one"),
        ("Stage", _stage(project), ""),
    )
    words = _comparable(search).split()
    if not words:
        return [row for title, rows, hint in sections for row in (LibraryRow(title), *(rows or [_hint(hint)]))]
    found = [(title, [row for row in rows if _holds(row.text, words)]) for title, rows, _ in sections]
    hits = [row for title, rows in found if rows for row in (LibraryRow(title), *rows)]
    return hits or [_hint(f"No name holds '{search.strip()}'. Press Esc in the field to list everything.")]


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
    return [
        LibraryRow(
            capture.name,
            f"{capture.duration:.1f} s · {capture.frame_rate:.4g} Hz",
            ("captures", key),
            strong=motion is not None and key == motion.capture_id,
        )
        for key, capture in project.captures.items()
    ]


def _bodies(project: Project) -> list[LibraryRow]:
    rows = []
    for key, performer in project.performers.items():
        character = project.characters[performer.character_id]
        rows.append(
            LibraryRow(
                performer.name, _stature(character), ("performers", key), character.colour, shown=performer.visible
            )
        )
    on_stage = {performer.character_id for performer in project.performers.values()}
    for key, character in project.characters.items():
        if key not in on_stage:
            rows.append(
                LibraryRow(character.name, _stature(character), ("characters", key), character.colour, shown=False)
            )
    return rows


def _stature(character: Character) -> str:
    """``1.66 m``, or ``1.20 – 1.94 m`` for a growing character."""
    keyed = character.proportions
    if not isinstance(keyed, KeyedProportions):
        return f"{character.morphology.stature:.2f} m"
    statures = [each.applied_to(character.build).stature for each in keyed.values]
    return f"{min(statures):.2f} – {max(statures):.2f} m"


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
    """Point of a constraint, unless its name contains it."""
    words = constraint.shown.about or point_words(constraint.point)
    return "" if words in constraint.name.lower() else words


def _stage(project: Project) -> list[LibraryRow]:
    props = [LibraryRow(prop.name, "prop", ("props", key)) for key, prop in project.props.items()]
    ground = project.ground
    words = f"{ground.height:.2f} m" if ground.is_level else ground.kind.replace("_", " ")
    return [LibraryRow("Ground", words, ("grounds", GROUND_ID)), *props]
