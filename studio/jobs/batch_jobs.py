"""Jobs of a batch: one capture each, identified by the content of everything on which its result depends."""

import hashlib
import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from studio import __version__
from studio.core.errors import StudioError
from studio.io.json_text import JsonObject, write_json
from studio.io.referenced_files import read_bytes
from studio.io.registry import known_formats
from studio.jobs.adapted_files import AdaptSettings, adapt_file

REPORTS_FOLDER = "reports"
"""Name of the subfolder of the batch's folder with a report for each capture."""


@dataclass(frozen=True)
class BatchJob:
    """Capture to adapt, as plain values that any process on any machine can take."""

    name: str
    """Path of the capture relative to the folder of the batch, with slashes."""
    capture: Path
    folder: Path
    """Folder for the adapted files."""
    report: Path
    """JSON file with the record of the job; it is written last."""
    size: int
    """Size of the capture in bytes."""
    digest: str
    """Digest of capture, characters, constraints and options: equal digests mean equal results."""
    settings: AdaptSettings


def find_jobs(source: Path, out: Path, settings: AdaptSettings) -> list[BatchJob]:
    """Jobs for all captures in ``source`` and its subfolders, except those under ``out``. Raises StudioError."""
    if not source.is_dir():
        raise StudioError(f"'{source}' is not a folder. Name the folder that holds the captures.")
    suffixes, own = known_formats().suffixes("capture_reader"), out.resolve()
    if source.resolve() == own:
        raise StudioError(f"'{source}' holds the captures. Name another folder with --out for what is adapted.")
    found = (path for path in sorted(source.rglob("*")) if path.suffix.lower() in suffixes and path.is_file())
    captures = [path for path in found if own not in path.resolve().parents]
    if not captures:
        raise StudioError(f"'{source}' holds no captures. The studio reads {', '.join(suffixes)}.")
    settings = settings.absolute
    asked = _digest_of(settings)
    stems = Counter(path.with_suffix("") for path in captures)
    jobs = []
    for path in captures:
        name = path.relative_to(source)
        folder = out / (name if stems[path.with_suffix("")] > 1 else name.parent)
        content, report = read_bytes(path), out / REPORTS_FOLDER / f"{name}.json"
        digest = hashlib.sha256(asked + content).hexdigest()
        places = path.resolve(), folder.resolve(), report.resolve()
        jobs.append(BatchJob(name.as_posix(), *places, len(content), digest, settings))
    return jobs


def finished_record(job: BatchJob) -> JsonObject | None:
    """Record of an earlier run with the same inputs, whose files are unchanged; None if there is none."""
    try:
        record: JsonObject = json.loads(job.report.read_bytes())
        written = dict(record["written"])
        same = record["digest"] == job.digest and all(_hash(Path(path)) == known for path, known in written.items())
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None  # no report, or not one of a batch: the job is done again
    return record if same else None


def adapt_job(job: BatchJob) -> JsonObject:
    """Adapt one capture in this process and return its record; an error is reported in the record, and
    stops nothing.
    """
    start = perf_counter()
    record: JsonObject = {"name": job.name, "digest": job.digest}
    try:
        record |= adapt_file(job.capture, job.settings, job.settings.cast(), job.folder)
        record["written"] = {each["file"]: _hash(Path(each["file"])) for each in record["characters"]}
        record["seconds"] = perf_counter() - start
        job.report.parent.mkdir(parents=True, exist_ok=True)
        write_json(job.report, record)
    except StudioError as error:
        return failure_record(job, str(error))
    except Exception as error:  # noqa: BLE001 - a fault of ours or of a format from outside costs this file alone
        return failure_record(job, f"{job.name}: an error of the studio itself, {type(error).__name__}: {error}")
    return record


def failure_record(job: BatchJob, error: str) -> JsonObject:
    """Record of a capture that could not be adapted."""
    return {"name": job.name, "digest": job.digest, "error": error, "characters": []}


def death_record(job: BatchJob) -> JsonObject:
    """Record of a capture on which the worker processes died."""
    return failure_record(job, f"{job.name}: every worker that was given this file died of it. Look at it alone.")


def _digest_of(settings: AdaptSettings) -> bytes:
    digest = hashlib.sha256(f"{__version__} {settings}".encode())
    for path in settings.files:
        digest.update(read_bytes(path))
    return digest.digest()


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
