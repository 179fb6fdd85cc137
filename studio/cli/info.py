"""``info``: print the content of files, the guesses made, and the round-trip error."""

import sys
from argparse import Namespace
from collections.abc import Iterable
from math import degrees
from pathlib import Path
from textwrap import wrap

import numpy as np

from studio.cli.import_arguments import import_options
from studio.cli.printing import print_json
from studio.core.captures.capture import Capture, Guess
from studio.core.captures.remarks import body_remarks, remarks_on
from studio.core.errors import StudioError
from studio.core.markers.take import MarkerTake, centre_errors
from studio.core.names import counted_noun
from studio.core.normalized.floor_guesses import floor_drift, steps_guess
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.round_trip import round_trip
from studio.core.rigs.character_skeleton import character_body_map, character_skeleton
from studio.core.stage.project import COLLECTIONS
from studio.io.importing import ImportOptions, known_of_motion, read_file
from studio.io.json_text import JsonObject
from studio.io.project.project_file import read_project
from studio.io.registry import ReadCapture, ReadCharacter
from studio.jobs.adaptation import ADAPTED_MOTION_ID, cleaning_records, spans_by_foot
from studio.startup.kernel_warm_up import print_wait_reason

_NOTHING: JsonObject = {
    "ok": True,
    "error": None,
    "kind": None,
    "frames": None,
    "frame_rate": None,
    "joints": None,
    "unit": None,
    "up_axis": None,
    "body_map": {},
    "contacts": {},
    "round_trip": None,
    "assumptions": [],
    "repairs": [],
    "remarks": [],
}


def run(arguments: Namespace) -> int:
    """Describe every file; returns 1 if any cannot be read."""
    options = import_options(arguments)
    records = [file_record(path, options) for path in arguments.files]
    failed = [record for record in records if not record["ok"]]
    if arguments.json:
        print_json(records)
    else:
        print("\n\n".join("\n".join(lines_of(record)) for record in records if record["ok"]))
        for record in failed:
            print(f"morpho-studio: {record['error']}", file=sys.stderr)
    return 1 if failed else 0


def file_record(path: Path, options: ImportOptions) -> JsonObject:
    """Record of one file with the keys of ``_NOTHING``; for a file that cannot be read, the reason is under
    ``error``.
    """
    record = {"file": str(path), **_NOTHING}
    try:
        return record | (_project if path.suffix.lower() == ".studio" else _foreign)(path, options)
    except StudioError as error:
        return record | {"ok": False, "error": str(error)}


def _foreign(path: Path, options: ImportOptions) -> JsonObject:
    print_wait_reason()
    read = read_file(path, options)
    return _character(read) if isinstance(read, ReadCharacter) else _capture(read)


def _capture(read: ReadCapture) -> JsonObject:
    capture, report = read.capture, read.report
    annotations = known_of_motion(capture, read.annotations, ADAPTED_MOTION_ID)
    steps = steps_guess(capture)
    return {
        "kind": "skeleton",
        "frames": capture.frame_count,
        "frame_rate": capture.frame_rate,
        "joints": int(np.count_nonzero(~capture.skeleton.end_sites)),
        "unit": capture.unit,
        "up_axis": capture.up_axis,
        "body_map": capture.body_map.to_json(capture.skeleton) if capture.body_map else {},
        "contacts": spans_by_foot(annotations.contacts or ()) if capture.body_map else {},
        "round_trip": _round_trip(capture),
        "assumptions": _sentences((*report.guesses, *([steps] if steps else []))),
        "repairs": list(report.repairs),
        "remarks": [remark.sentence for remark in remarks_on(capture)],
        "first_frame": capture.first_frame,
        "floor": capture.floor,
        "floor_drift": floor_drift(capture),
        "end_sites": int(np.count_nonzero(capture.skeleton.end_sites)),
        **({"markers": _markers(capture.markers, capture)} if capture.markers else {}),
    }


def _markers(take: MarkerTake, capture: Capture) -> JsonObject:
    """Record of an optical capture's markers, signals, plates and events, and of the roles given to its markers."""
    trial = take.trial
    events = [{"label": f"{e.context} {e.label}".strip(), "time": e.time} for e in trial.events]
    return {
        "points": len(trial.labels),
        "markers": len(trial.markers),
        "first_recorded_frame": trial.first_frame,
        "signals": len(trial.analog.labels),
        "signal_rate": trial.analog.rate if trial.analog.labels else None,
        "force_plates": [plate.kind for plate in trial.plates],
        "events": events,
        "cleaning": cleaning_records(capture),
        "map": {role: list(labels) for role, labels in take.marker_map.markers.items()},
        "joint_centres_mm": {joint: 1000.0 * error for joint, error in centre_errors(take).items()},
    }


def _sentences(guesses: Iterable[Guess]) -> list[str]:
    return [f"{guess.title}. {guess.reason}" for guess in guesses]


def _round_trip(capture: Capture) -> JsonObject | None:
    if capture.body_map is None:
        return None
    error = round_trip(capture, *normalize_capture(capture))
    return {"position_mm": 1000.0 * error.position, "rotation_deg": degrees(error.rotation)}


def _character(read: ReadCharacter) -> JsonObject:
    character = read.character
    look = character.skin.appearance
    skeleton = character_skeleton(character.morphology)
    return {
        "kind": "character",
        "joints": int(np.count_nonzero(~skeleton.end_sites)),
        "unit": "m",
        "up_axis": "Z",
        "body_map": dict(read.joints) or character_body_map(character.morphology.layout).to_json(skeleton),
        "assumptions": _sentences(read.guesses),
        "repairs": list(read.repairs),
        "remarks": [remark.sentence for remark in body_remarks(character.build)],
        "name": character.name,
        "stature": character.morphology.stature,
        "vertices": len(character.skin.vertices),
        "materials": len(look.materials) if look else 0,
        "textures": sum(material.texture is not None for material in look.materials) if look else 0,
    }


def _project(path: Path, _options: ImportOptions) -> JsonObject:
    opened = read_project(path)
    counts = {name: len(getattr(opened.project, name)) for name in COLLECTIONS}
    return {"kind": "project", "repairs": [*opened.problems, *opened.remarks], "contents": counts}


def lines_of(record: JsonObject) -> list[str]:
    """Lines of text about one file, for people."""
    facts = [("error", record["error"])] if record["error"] else [("kind", record["kind"])]
    facts += [(_label(key), _words(record, key)) for key in _SHOWN if record.get(key) not in (None, {}, [])]
    facts += [(key[:-1], sentence) for key in ("assumptions", "repairs", "remarks") for sentence in record[key]]
    return [record["file"], *(_wrapped(label, text) for label, text in facts)]


_SHOWN = (
    *(
        "name",
        "stature",
        "vertices",
        "materials",
        "textures",
        "frames",
        "frame_rate",
        "joints",
        "unit",
        "up_axis",
        "first_frame",
        "floor",
        "floor_drift",
    ),
    *("body_map", "contacts", "round_trip", "markers", "contents"),
)


def _wrapped(label: str, text: str) -> str:
    lines = wrap(text, 95, break_long_words=False, break_on_hyphens=False) or [""]
    return f"\n{' ' * 15}".join([f"  {label:<12} {lines[0]}", *lines[1:]])


def _label(key: str) -> str:
    return key.replace("_", " ")


def _words(record: JsonObject, key: str) -> str:
    value = record[key]
    match key:
        case "round_trip":
            return f"max. {value['position_mm']:.2g} mm, {value['rotation_deg']:.2g} degrees"
        case "contacts":
            return ", ".join(f"{len(spans)} {_label(foot)}" for foot, spans in value.items())
        case "contents":
            return ", ".join(counted_noun(count, name.removesuffix("s")) for name, count in value.items() if count)
        case "markers":
            counts = [f"{counted_noun(value['markers'], 'marker')} of {counted_noun(value['points'], 'point')}"]
            counts += [
                counted_noun(value["signals"], "signal"),
                counted_noun(len(value["force_plates"]), "force plate"),
            ]
            counts += [counted_noun(len(value["events"]), "event")]
            worst = max(value["joint_centres_mm"].values(), default=None)
            near = [] if worst is None else [f"joint centres within {worst:.4f} mm of those stored"]
            return ", ".join(counts + near)
        case "body_map":
            return ", ".join(f"{_label(part)} {joint}" for part, joint in value.items())
        case "frame_rate":
            return f"{value:g} fps"
        case "floor" | "floor_drift" | "stature":
            return f"{value:.3f} m"
    return str(value)
