"""Marker maps in files: those that come with the studio, the user's own, and which one fits a trial."""

import json
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from platformdirs import user_data_path

from studio.core.errors import StudioError
from studio.core.markers.marker_map import MarkerMap, seen_labels
from studio.core.markers.proposing import propose_map
from studio.core.markers.trial import MARKER, VIRTUAL, Trial, subject_of
from studio.io.json_text import read_json
from studio.io.replacing import write_whole
from studio.resources_folder import resources_folder

_SIDES = ({"side": "left", "Side": "Left", "S": "L", "s": "l"}, {"side": "right", "Side": "Right", "S": "R", "s": "r"})
_LARGEST = 1 << 20


def find_map(trial: Trial, subject: str = "") -> MarkerMap:
    """The known map that explains most of the trial's markers, the user's before the studio's; else a proposal."""
    labels = set(seen_labels(trial, subject, (MARKER, VIRTUAL)).values())
    best: tuple[int, MarkerMap | None] = (0, None)
    for known in known_maps():
        fitting = fitted(known, labels)
        if (fitting.has_legs() or fitting.has_arms()) and len(fitting.markers) + len(fitting.centres) > best[0]:
            best = (len(fitting.markers) + len(fitting.centres), fitting)
    return best[1] or propose_map(trial, subject)


def find_subject(trial: Trial) -> str:
    """The subject with the most markers where labels name several; empty where all are one's."""
    subjects = [subject_of(label) for label in trial.markers]
    names = dict.fromkeys(subjects)
    return max(names, key=subjects.count) if len(names) > 1 else ""


def fitted(known: MarkerMap, labels: Iterable[str]) -> MarkerMap:
    """What of a map is there, with the labels as the trial writes them: ``lasi`` or ``Skeleton_LASI`` for ``LASI``."""
    written: dict[str, str] = {}
    for label in labels:
        written.setdefault(label.lower(), label)
        written.setdefault(label.lower().rpartition("_")[2], label)
    markers = {
        role: tuple(written[label.lower()] for label in own if label.lower() in written)
        for role, own in known.markers.items()
        if any(label.lower() in written for label in own)
    }
    centres = {j: written[label.lower()] for j, label in known.centres.items() if label.lower() in written}
    return MarkerMap(known.name, markers, centres)


def known_maps() -> tuple[MarkerMap, ...]:
    """The user's maps, then the studio's; those that cannot be read are told by ``unreadable_maps``."""
    return _read_maps()[0]


def unreadable_maps() -> tuple[str, ...]:
    """For each map of the user's that cannot be read a sentence that says why."""
    return _read_maps()[1]


def _read_maps() -> tuple[tuple[MarkerMap, ...], tuple[str, ...]]:
    own = sorted(maps_folder().glob("*.json")) if maps_folder().is_dir() else []
    found, failures = [], []
    for path in own:
        try:
            found.append(read_map(path))
        except StudioError as error:
            failures.append(f"The marker map {path} was left out: {error}")
    return (*found, *_shipped_maps()), tuple(failures)


@lru_cache(maxsize=1)
def _shipped_maps() -> tuple[MarkerMap, ...]:
    return tuple(map(read_map, sorted((resources_folder() / "marker_maps").glob("*.json"))))


def maps_folder() -> Path:
    """Where the user's maps are kept from one session to the next."""
    return user_data_path("morpho-studio", appauthor=False) / "marker_maps"


def read_map(path: Path) -> MarkerMap:
    """The map in a JSON file; raises StudioError with the file and what to do."""
    record = read_json(path, _LARGEST)
    try:
        return map_of(record)
    except (StudioError, KeyError, TypeError, AttributeError, ValueError) as error:
        raise StudioError(
            f"{path.name} is not a marker map: {error}. It is a record of a name and of markers by place, "
            '{"name": "Ours", "markers": {"left_knee": ["LKNE"], ...}}.'
        ) from error


def map_of(record: Mapping[str, Any]) -> MarkerMap:
    """A map out of JSON; ``{side}`` and ``{S}`` stand for both sides."""
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
    """Keep a map, by default among the user's own under its name; returns where. Raises StudioError."""
    if path is None:
        name = re.sub(r"[^\w -]+", "_", marker_map.name).strip() or "markers"
        path = maps_folder() / f"{name}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
    record: dict[str, Any] = {"name": marker_map.name}
    record["markers"] = {role: list(labels) for role, labels in marker_map.markers.items()}
    if marker_map.centres:
        record["centres"] = dict(marker_map.centres)
    write_whole(path, (json.dumps(record, indent=2, ensure_ascii=False) + "\n").encode())
    return path


def _filled(text: str, side: Mapping[str, str]) -> str:
    for word, own in side.items():
        text = text.replace("{" + word + "}", own)
    return text
