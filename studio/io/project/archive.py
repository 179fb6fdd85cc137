"""ZIP archive of stored members that is always whole: written beside the old one, verified and renamed; damage is
detected.

Members carry their CRC-32; the archive's comment is a seal, the SHA-256 of all bytes before it.
"""

import hashlib
import os
import struct
import zipfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from studio.core.errors import StudioError
from studio.io.atomic_write import FolderNotWritable, atomic_replacement, remove_leftovers
from studio.io.referenced_files import SNIFFED_BYTES, refuse_devices, refuse_stand_in
from studio.io.zipped import UnpacksTooFarError, unzipped_members

SEAL_PREFIX = b"morpho-studio sha256:"
DIGEST_SIZE = 64
_SIGNATURE = b"PK\x03\x04"
_LOCAL_HEADER = struct.Struct("<4s5H3I2H")
_EPOCH = (1980, 1, 1, 0, 0, 0)

_SPARE_BYTES = 100_000_000
"""Bytes to which a compressed archive may unpack beside twenty times its size: members are there twice for a moment."""
_MAX_DAMAGED_MEMBERS = 100  # a file made to keep the reader busy has many more

Stamp = tuple[int, int, int]


@dataclass
class Archive:
    """Content of an archive: members that could be read, names of damaged ones, and whether the seal is unbroken."""

    members: dict[str, bytes] = field(default_factory=dict)
    damaged: list[str] = field(default_factory=list)
    sealed: bool = False


def stamp(path: Path) -> Stamp | None:
    """Stamp of a file that changes with every write: node, size and time; None without a file."""
    try:
        status = path.stat()
    except FileNotFoundError:
        return None
    return status.st_ino, status.st_size, status.st_mtime_ns


def read_archive(path: Path) -> Archive:
    """Archive with all intact members. Raises StudioError if the file cannot be read or is no archive."""
    refuse_devices(path)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise StudioError(f"'{path}' cannot be read: {error.strerror}.") from error
    if not content:
        raise StudioError(f"'{path.name}' is empty: there is no project in it.")
    archive = _walked(content)
    archive.sealed = _is_sealed(content)
    if not archive.sealed and not archive.damaged:
        archive.members |= _repacked(path, content)
    if not archive.members and not archive.damaged:
        refuse_stand_in(path.name, content[:SNIFFED_BYTES])
        raise StudioError(f"'{path.name}' is not a Morpho Studio project: it is not a ZIP archive.")
    return archive


def read_member(path: Path, name: str, most_bytes: int) -> bytes | None:
    """Content of a member, read without the others; None if it is missing, damaged or larger than ``most_bytes``."""
    try:
        refuse_devices(path)
        with zipfile.ZipFile(path) as archive:
            return archive.read(name) if archive.getinfo(name).file_size <= most_bytes else None
    except (StudioError, OSError, KeyError, ValueError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error):
        return None  # opening the project says what is the matter with its file


def write_archive(
    path: Path,
    members: Mapping[str, bytes],
    report: Callable[[float, str], None] = lambda _share, _text: None,
) -> Stamp:
    """Replace ``path`` by an archive of ``members``, or leave it unchanged; return its stamp.

    ``report`` is called with the finished fraction and may raise an exception to cancel. Raises FolderNotWritable or
    StudioError.
    """
    path = path.resolve()
    remove_leftovers(path)
    try:
        with atomic_replacement(path) as part:
            _write_members(part, members, report)
            _seal(part)
            _verify(part, members)
    except FolderNotWritable as error:
        raise FolderNotWritable(f"{error} Nothing is lost: use File > Save as…") from error
    written = stamp(path)
    if written is None:
        raise StudioError(f"'{path}' disappeared right after it was saved. Save it in another place.")
    return written


def _write_members(part: Path, members: Mapping[str, bytes], report: Callable[[float, str], None]) -> None:
    total = sum(map(len, members.values())) or 1
    done = 0
    with zipfile.ZipFile(part, "w", zipfile.ZIP_STORED) as archive:
        for name, content in members.items():
            report(done / total, f"Writing {name.split('/')[0]}")
            archive.writestr(zipfile.ZipInfo(name, _EPOCH), content)
            done += len(content)
        archive.comment = SEAL_PREFIX + b"0" * DIGEST_SIZE


def _seal(part: Path) -> None:
    """Append the digest of all bytes before it."""
    with open(part, "r+b") as stream:
        length = stream.seek(0, os.SEEK_END) - DIGEST_SIZE
        stream.seek(0)
        digest = hashlib.sha256()
        while block := stream.read(min(1 << 20, length - stream.tell())):
            digest.update(block)
        stream.seek(length)
        stream.write(digest.hexdigest().encode())


def _verify(part: Path, members: Mapping[str, bytes]) -> None:
    written = read_archive(part)
    if not written.sealed or written.members != members:
        raise StudioError("The disk did not keep what was written to it. Save the project on another disk.")


def _is_sealed(content: bytes) -> bool:
    digest = content[-DIGEST_SIZE:]
    if content[-DIGEST_SIZE - len(SEAL_PREFIX) : -DIGEST_SIZE] != SEAL_PREFIX:
        return False
    return hashlib.sha256(memoryview(content)[:-DIGEST_SIZE]).hexdigest().encode() == digest


def _walked(content: bytes) -> Archive:
    """Stored members found by their own headers, in case the directory is damaged or missing."""
    archive = Archive()
    start = content.find(_SIGNATURE)
    while 0 <= start <= len(content) - _LOCAL_HEADER.size and len(archive.damaged) < _MAX_DAMAGED_MEMBERS:
        _, _, flags, method, _, _, crc, size, full, name_size, extra = _LOCAL_HEADER.unpack_from(content, start)
        named = start + _LOCAL_HEADER.size
        name = content[named : named + name_size].decode("ascii", "replace")
        begin = named + name_size + extra
        if flags & 8 or method or size != full:
            start = content.find(_SIGNATURE, start + 4)
        elif len(body := content[begin : begin + size]) == size and zlib.crc32(body) == crc:
            archive.members.setdefault(name, body)
            start = content.find(_SIGNATURE, begin + size)
        else:
            archive.damaged.append(name if name.isprintable() else "a member without a readable name")
            start = content.find(_SIGNATURE, start + 4)
    return archive


def _repacked(path: Path, content: bytes) -> dict[str, bytes]:
    """Members of an archive that another program has repacked, perhaps compressed; none if it is not an archive."""
    try:
        return unzipped_members(content, 20 * len(content) + _SPARE_BYTES)
    except UnpacksTooFarError as error:
        raise StudioError(
            f"'{path.name}' {error}, and a project is not that much smaller when it is packed. Ask its author"
            " for the file as it was saved."
        ) from error
    except ValueError:
        return {}
