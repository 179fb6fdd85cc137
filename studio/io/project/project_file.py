"""The ``.studio`` file: a project with its captures, characters and last ten versions, always whole.

Members: ``manifest.json`` (document id, SHA-256 and size of each member), ``project.json`` (``entity_json``),
``captures/<sha256>.npy``, ``characters/<sha256>.npy``, ``history/NNN.json``, ``thumbnail.png``.
"""

import hashlib
import re
import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from studio.core.constraints.objections import objections
from studio.core.errors import StudioError
from studio.core.stage.project import Project
from studio.io.atomic_write import FolderNotWritable
from studio.io.npy import array_of
from studio.io.project.archive import Archive, Stamp, read_archive, read_member, stamp, write_archive
from studio.io.project.entity_json import (
    MEMBER_NAME_PATTERN,
    PROJECT_SCHEMA,
    Members,
    named_members,
    npy_bytes,
    parse_member,
    project_json,
    project_of,
    record_line,
)
from studio.io.project.upgrades import schema_of, upgraded_record
from studio.io.project.value_json import Array, Json

__all__ = [
    "ChangedOnDisk",
    "FolderNotWritable",
    "OpenedProject",
    "document_id_of",
    "new_document_id",
    "read_project",
    "read_thumbnail",
    "write_project",
]

MANIFEST_FILE, PROJECT_FILE, THUMBNAIL_FILE = "manifest.json", "project.json", "thumbnail.png"
HISTORY_MEMBER_PATTERN = re.compile(r"history/(\d{3,9})\.json")
KEPT_VERSIONS = 10
_MOST_THUMBNAIL_BYTES = 4_000_000
_PLAIN_ID = re.compile("[0-9A-Za-z]{1,64}")


class ChangedOnDisk(StudioError):  # noqa: N818 - it names what is the matter
    """Error: another program has written the file since it was opened."""


@dataclass(frozen=True)
class OpenedProject:
    """Project as it was read; with ``problems`` it is incomplete, and the file must not be replaced."""

    project: Project
    path: Path
    document_id: str
    stamp: Stamp | None
    read_only: bool = False
    problems: tuple[str, ...] = ()
    versions: tuple[str, ...] = ()
    """Earlier versions in the file, newest first: member names for ``read_project(path, version)``."""
    remarks: tuple[str, ...] = ()
    """Sentences about parts that are intact but inconsistent with each other."""


def new_document_id() -> str:
    """New id of a document, which its file keeps under any name."""
    return uuid.uuid4().hex


def document_id_of(path: Path) -> str | None:
    """Id of the document in a project's file; None without such a file or id."""
    if not path.is_file():
        return None
    try:
        manifest, _ = _checked(read_archive(path), path, [])
    except StudioError:  # it is no project
        return None
    return _document_id(manifest)


def write_project(
    path: Path,
    project: Project,
    document_id: str,
    *,
    thumbnail: bytes | None = None,
    expected: Stamp | None = None,
    report: Callable[[float, str], None] = lambda _share, _text: None,
) -> Stamp:
    """Save ``project``, and return the stamp of the file; the file is either replaced as a whole or left unchanged.

    ``expected`` is the stamp of the file as it was opened; ChangedOnDisk is raised if it has changed. Raises
    FolderNotWritable if another folder is needed, and StudioError for any other obstacle.
    """
    if expected is not None and stamp(path) not in (expected, None):
        raise ChangedOnDisk(
            f"'{path.name}' was changed on the disk since it was opened here. Save under another name, or"
            " save again to replace it."
        )
    report(0.0, "Collecting")
    arrays: Members = {}
    members = {PROJECT_FILE: project_json(project, arrays)}
    members |= _earlier(path, document_id, members[PROJECT_FILE])
    members |= project.carried.get("members", {})
    members |= {name: npy_bytes(array) for name, array in sorted(arrays.items())}
    if thumbnail is not None:
        members[THUMBNAIL_FILE] = thumbnail
    return write_archive(path, {MANIFEST_FILE: _manifest(document_id, members), **members}, report)


def read_project(path: Path, version: str = PROJECT_FILE) -> OpenedProject:
    """Project in a file, or in an earlier ``version`` of it, as far as its hashes are right.

    Damaged parts are left out and listed. Raises StudioError if nothing can be opened.
    """
    archive = read_archive(path)
    problems = [f"'{name}' in '{path.name}' is damaged." for name in dict.fromkeys(archive.damaged)]
    manifest, intact = _checked(archive, path, problems)
    versions = tuple(sorted((name for name in intact if HISTORY_MEMBER_PATTERN.fullmatch(name)), reverse=True))
    chosen = _newest_readable(path, (version, *versions) if version == PROJECT_FILE else (version,), intact, problems)
    record = parse_member(intact[chosen], chosen)
    schema = schema_of(record, chosen)
    read = project_of(upgraded_record(record, chosen), lambda name: _array(intact, name))
    problems += read.losses
    read_only = schema > PROJECT_SCHEMA
    if read_only:
        problems.append(
            f"'{path.name}' was saved by a newer version of Morpho Studio (schema {schema}, this one knows"
            f" {PROJECT_SCHEMA}). It is open for reading; to keep changes, save under another name."
        )
    if not archive.sealed and not problems:
        problems.append(f"'{path.name}' was changed by another program or damaged; all its members are right.")
    return OpenedProject(
        _with_foreign_members(read.project, intact, manifest),
        path,
        _document_id(manifest) or new_document_id(),
        stamp(path),
        read_only,
        tuple(problems),
        versions,
        (*read.remarks, *objections(tuple(read.project.constraints.values()))),
    )


def read_thumbnail(path: Path) -> bytes | None:
    """PNG of the stage when the project was saved; None if there is none that can be read."""
    return read_member(path, THUMBNAIL_FILE, _MOST_THUMBNAIL_BYTES)


def _document_id(manifest: Mapping[str, Json]) -> str | None:
    """Document id, accepted only if it consists of letters and digits, because files are named by it."""
    found = manifest.get("document")
    return found if isinstance(found, str) and _PLAIN_ID.fullmatch(found) else None


def _manifest(document_id: str, members: Mapping[str, bytes]) -> bytes:
    sums = {name: {"sha256": _sha(content), "size": len(content)} for name, content in members.items()}
    lines = ",\n".join(f"{record_line(name)}:{record_line(item)}" for name, item in sorted(sums.items()))
    return f'{{"document":{record_line(document_id)},"schema":{PROJECT_SCHEMA},"members":{{\n{lines}\n}}}}\n'.encode()


def _earlier(path: Path, document_id: str, current: bytes) -> dict[str, bytes]:
    """Versions to keep from the file that is about to be replaced, with their members."""
    if not path.exists():
        return {}
    try:
        archive = read_archive(path)
    except StudioError:  # it is no project, so it holds no version of this one
        return {}
    manifest, intact = _checked(archive, path, [])
    if manifest.get("document") != document_id:
        return {}
    numbers = {int(found[1]): name for name in intact if (found := HISTORY_MEMBER_PATTERN.fullmatch(name))}
    kept = {number: intact[name] for number, name in numbers.items()}
    if PROJECT_FILE in intact and intact[PROJECT_FILE] != current:
        kept[max(kept, default=0) + 1] = intact[PROJECT_FILE]
    versions = {f"history/{number:03}.json": kept[number] for number in sorted(kept)[-KEPT_VERSIONS:]}
    named = {name for content in versions.values() for name in _named_in(content)}
    return versions | {name: intact[name] for name in sorted(named & intact.keys())}


def _named_in(content: bytes) -> set[str]:
    return {match.group() for match in MEMBER_NAME_PATTERN.finditer(content.decode("utf-8", "replace"))}


def _checked(archive: Archive, path: Path, problems: list[str]) -> tuple[dict[str, Json], dict[str, bytes]]:
    """Manifest ({} if lost) and the members with a valid hash; ``problems`` lists the others."""
    manifest: dict[str, Json] = {}
    try:
        found = parse_member(archive.members.get(MANIFEST_FILE, b""), MANIFEST_FILE)
        manifest = found if isinstance(found, dict) and isinstance(found.get("members"), dict) else {}
    except StudioError:
        problems.append(f"'{MANIFEST_FILE}' in '{path.name}' is missing or damaged.")
    sums = manifest.get("members", {})
    intact = {}
    for name, content in archive.members.items():
        listed = sums.get(name, {})
        digest = _sha(content)
        addressed = not MEMBER_NAME_PATTERN.fullmatch(name) or name.split("/")[1].startswith(digest)
        if addressed and isinstance(listed, dict) and listed.get("sha256", digest) == digest:
            intact[name] = content
        else:
            problems.append(f"'{name}' in '{path.name}' is not what was saved: its hash is wrong.")
    problems += [
        f"'{name}' is missing from '{path.name}'."
        for name in sums
        if name not in archive.members and name not in archive.damaged
    ]
    return manifest, intact


def _newest_readable(path: Path, names: tuple[str, ...], intact: dict[str, bytes], problems: list[str]) -> str:
    for name in names:
        try:
            schema_of(parse_member(intact[name], name), name)
        except (KeyError, StudioError) as error:
            problems.append(f"'{name}' cannot be used." if isinstance(error, KeyError) else str(error))
        else:
            if name != names[0]:
                problems.append(f"An earlier version is opened in its place: {name}.")
            return name
    raise StudioError(
        f"'{names[0]}' in '{path.name}' is missing or damaged, and no earlier version is in the file. "
        + " ".join(problems)
        + " Open a copy of the file, if there is one."
    )


def _array(intact: dict[str, bytes], name: str) -> Array:
    if not MEMBER_NAME_PATTERN.fullmatch(name):
        raise ValueError(f"'{name}' is not the name of a member.")
    if name not in intact:
        raise ValueError(f"'{name}' is missing or damaged.")
    try:
        return array_of(intact[name])
    except (ValueError, TypeError, SyntaxError, OverflowError) as error:
        raise ValueError(f"'{name}' is not an array: {error}.") from error


def _with_foreign_members(project: Project, intact: dict[str, bytes], manifest: dict[str, Json]) -> Project:
    """Project with the bytes of its unknown parts, and unknown members."""
    named = named_members(dict(project.carried))
    own = (MANIFEST_FILE, PROJECT_FILE, THUMBNAIL_FILE)
    listed = {name for name in manifest.get("members", {}) if not MEMBER_NAME_PATTERN.fullmatch(name)}
    foreign = {
        name: content
        for name, content in intact.items()
        if name in named or (name in listed and not (name in own or HISTORY_MEMBER_PATTERN.fullmatch(name)))
    }
    return replace(project, carried={**project.carried, "members": foreign}) if foreign else project


def _sha(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
