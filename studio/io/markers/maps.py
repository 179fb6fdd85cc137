"""Files of marker maps: bundled ones, the user's own, and the choice of one for a trial."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from platformdirs import user_data_path

from studio.core.errors import StudioError
from studio.core.markers.ends import exchanged_ends, exchanged_on_limbs, with_roles
from studio.core.markers.marker_map import MarkerMap, seen_labels
from studio.core.markers.proposing import propose_map
from studio.core.markers.sides import exchanged_places, with_sides_exchanged
from studio.core.markers.trial import MARKER_KIND, VIRTUAL_KIND, Trial, subject_of
from studio.io.atomic_write import write_atomically
from studio.io.json_text import read_json
from studio.resources_folder import resources_folder

_SIDES = ({"side": "left", "Side": "Left", "S": "L", "s": "l"}, {"side": "right", "Side": "Right", "S": "R", "s": "r"})
_LARGEST = 1 << 20
_ADRIFT = ("thigh", "shank", "upper_arm", "forearm", "hip")
"""Places that are anywhere on a bone: a known map leaves them open on purpose."""


def find_map(trial: Trial, subject: str = "") -> MarkerMap:
    """Map of a trial's markers, with sides and ends of limbs corrected that are exchanged through the whole trial.

    It is a map of the user if one can track a body, else the bundled map that explains most markers, completed by a
    proposal; else a proposal.
    """
    labels = list(seen_labels(trial, subject, (MARKER_KIND, VIRTUAL_KIND)).values())
    own = _best(_read_maps()[0], labels)
    if own is not None:
        return own
    proposed, known = propose_map(trial, subject), _best(_shipped_maps(), labels)
    found = proposed if known is None else _completed(known, proposed)
    found = with_roles(found, exchanged_ends(trial, found, subject))
    found = with_sides_exchanged(found, exchanged_places(trial, found, subject))
    return with_roles(found, exchanged_on_limbs(trial, found, subject))


def _best(maps: Iterable[MarkerMap], labels: Sequence[str]) -> MarkerMap | None:
    """Map with most roles among the labels, fitted to them; None if none can track a limb."""
    fitting = [fitted_map(each, labels) for each in maps]
    able = [each for each in fitting if each.has_legs() or each.has_arms()]
    return max(able, key=lambda each: len(each.markers) + len(each.centres), default=None)


def _completed(known: MarkerMap, proposed: MarkerMap) -> MarkerMap:
    """Map ``known`` without markers that are joint centres by measure, and with the roles of ``proposed`` that it
    leaves open.
    """
    centres = {joint: label for joint, label in proposed.centres.items() if joint not in known.centres}
    inside = set(centres.values())
    markers = {role: own for role, own in known.markers.items() if not inside & set(own)}
    used = inside | {label for own in markers.values() for label in own}
    open_places = {
        role: own
        for role, own in proposed.markers.items()
        if role not in markers and role.partition("_")[2] not in _ADRIFT and not used & set(own)
    }
    return MarkerMap(known.name, markers | open_places, {**known.centres, **centres})


def find_subject(trial: Trial) -> str:
    """Subject of a trial: the first one whose markers can track a body, else the one with most markers.

    It is empty if labels name fewer than two subjects.
    """
    subjects = [subject_of(label) for label in trial.markers]
    names = dict.fromkeys(subjects)
    if len(names) < 2:
        return ""
    most = max(names, key=subjects.count)
    return next((name for name in names if 2 * subjects.count(name) > subjects.count(most)), most)


def fitted_map(known: MarkerMap, labels: Iterable[str]) -> MarkerMap:
    """Map ``known`` restricted to a trial's labels, as they are written there: ``lasi`` or ``Skeleton_LASI`` for
    ``LASI``.
    """
    labels = list(labels)
    named = {label.lower() for own in known.markers.values() for label in own} | {
        label.lower() for label in known.centres.values()
    }
    beginnings = {"": None} | dict.fromkeys(
        label[: -len(rest)] for label in labels for rest in named if len(label) > len(rest) and _ends_with(label, rest)
    )
    beginning = max(beginnings, key=lambda each: len(_written(labels, each).keys() & named))
    written = _written(labels, beginning)
    markers = {
        role: tuple(written[label.lower()] for label in own if label.lower() in written)
        for role, own in known.markers.items()
    }
    centres = {j: written[label.lower()] for j, label in known.centres.items() if label.lower() in written}
    return MarkerMap(known.name, markers, centres)


def _ends_with(label: str, rest: str) -> bool:
    return label.lower().endswith(rest) and label[-len(rest) - 1] in "_.- "


def _written(labels: Iterable[str], beginning: str) -> dict[str, str]:
    """Labels by the part after the prefix ``beginning``, in lower case."""
    return {label[len(beginning) :].lower(): label for label in labels if label.startswith(beginning)}


def known_maps() -> tuple[MarkerMap, ...]:
    """Maps of the user, then the bundled ones; ``unreadable_maps`` reports the others."""
    return (*_read_maps()[0], *_shipped_maps())


def unreadable_maps() -> tuple[str, ...]:
    """Error messages, one for each map of the user that cannot be read."""
    return _read_maps()[1]


def _read_maps() -> tuple[tuple[MarkerMap, ...], tuple[str, ...]]:
    """Maps of the user, and an error message for each that cannot be read."""
    own = sorted(maps_folder().glob("*.json")) if maps_folder().is_dir() else []
    found, failures = [], []
    for path in own:
        try:
            found.append(read_map(path))
        except StudioError as error:
            failures.append(f"The marker map {path} was left out: {error}")
    return tuple(found), tuple(failures)


@lru_cache(maxsize=1)
def _shipped_maps() -> tuple[MarkerMap, ...]:
    return tuple(map(read_map, sorted((resources_folder() / "marker_maps").glob("*.json"))))


def maps_folder() -> Path:
    """Folder of the user's maps."""
    return user_data_path("morpho-studio", appauthor=False) / "marker_maps"


def read_map(path: Path) -> MarkerMap:
    """Map in a JSON file. Raises StudioError with the file and what to do."""
    record = read_json(path, _LARGEST)
    try:
        return map_of(record)
    except (StudioError, KeyError, TypeError, AttributeError, ValueError) as error:
        raise StudioError(
            f"{path.name} is not a marker map: {error}. It is a record of a name and of markers by place, "
            '{"name": "Ours", "markers": {"left_knee": ["LKNE"], ...}}.'
        ) from error


def map_of(record: Mapping[str, Any]) -> MarkerMap:
    """Map in a JSON record; ``{side}`` and ``{S}`` stand for both sides."""
    markers: dict[str, tuple[str, ...]] = {}
    centres: dict[str, str] = {}
    for role, labels in record["markers"].items():
        if not isinstance(labels, list) or not all(isinstance(label, str) for label in labels):
            raise StudioError(f"'{role}' needs a list of labels")
        for side in _SIDES if "{side}" in role else _SIDES[:1]:
            markers[_filled(role, side)] = tuple(_filled(label, side) for label in labels)
    for joint, label in record.get("centres", {}).items():
        for side in _SIDES if "{side}" in joint else _SIDES[:1]:
            centres[_filled(joint, side)] = _filled(str(label), side)
    return MarkerMap(str(record["name"]), markers, centres)


def save_map(marker_map: MarkerMap, path: Path | None = None) -> Path:
    """Save a map, by default among the user's own under its name, and return its path. Raises StudioError."""
    if path is None:
        name = re.sub(r"[^\w -]+", "_", marker_map.name).strip() or "markers"
        path = maps_folder() / f"{name}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
    record: dict[str, Any] = {"name": marker_map.name}
    record["markers"] = {role: list(labels) for role, labels in marker_map.markers.items()}
    if marker_map.centres:
        record["centres"] = dict(marker_map.centres)
    write_atomically(path, (json.dumps(record, indent=2, ensure_ascii=False) + "\n").encode())
    return path


def _filled(text: str, side: Mapping[str, str]) -> str:
    for word, own in side.items():
        text = text.replace("{" + word + "}", own)
    return text
