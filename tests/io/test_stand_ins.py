"""Stand-ins for a file are named as what they are, whatever the format."""

from pathlib import Path

import pytest

from studio.core.errors import StudioError
from studio.io.importing import load_capture, load_character
from studio.io.project.project_file import read_project
from studio.io.registry import known_formats

POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:0f\nsize 12345\n"
STAND_INS = {
    "a Git LFS pointer": (POINTER, "is a Git LFS pointer, not the file itself. Fetch it with 'git lfs pull'."),
    "a page": (b"\n<!DOCTYPE html>\n<html><body>Not found</body></html>", "is a web page, not the file itself."),
    "a page as XML": (b'<?xml version="1.0"?>\n<!-- x -->\n<html xmlns="x">', "is a web page, not the file itself."),
    "a server's refusal": (b"404: Not Found", "is a web page, not the file itself."),
    "a ZIP archive": (b"PK\x03\x04\x14\0\0\0\x08\0", "is a packed file (ZIP). Unpack it, then open the files"),
    "a gzipped file": (b"\x1f\x8b\x08\x08\0\0\0\0\0\x03", "is a packed file (gzip). Unpack it, then open the files"),
    "a tar archive": (b"a.bvh".ljust(257, b"\0") + b"ustar\x0000", "is a packed file (tar). Unpack it, then open"),
    "a picture": (b"\x89PNG\r\n\x1a\n" + bytes(40), "is a PNG picture, whatever its name says. Choose another file"),
    "a scene of Blender": (b"BLENDER-v405" + bytes(40), "is a Blender scene, whatever its name says. Choose another"),
    "a double of macOS": (b"\0\x05\x16\x07\0\x02\0\0Mac OS X", "is a note of macOS about another file, whatever"),
    "nothing": (b"", "is empty. Copy or export it again."),
    "blanks": (b"  \r\n\n\x1a", "is empty: it begins with nothing but blanks or zeros. Copy or export it again."),
    "zeros": (b"\0" * 5000, "is empty: it begins with nothing but blanks or zeros. Copy or export it again."),
}


@pytest.mark.parametrize("case", STAND_INS)
@pytest.mark.parametrize("suffix", known_formats().suffixes("capture_reader", "character_reader"))
def test_what_stands_for_a_file_is_named_whatever_its_suffix(tmp_path: Path, case: str, suffix: str) -> None:
    content, sentence = STAND_INS[case]
    path = tmp_path / f"take{suffix}"
    path.write_bytes(content)
    own = {each.packed for each in known_formats().formats if suffix in each.suffixes} - {""}
    if any(f"({kind})" in sentence for kind in own):
        sentence = "is "  # its reader says how it is damaged
    for job in ("capture_reader", "character_reader"):
        if suffix in known_formats().suffixes(job):
            with pytest.raises(StudioError) as refusal:
                (load_capture if job == "capture_reader" else load_character)(path)
            assert f"take{suffix}" in str(refusal.value)
            assert sentence in str(refusal.value)


@pytest.mark.parametrize("case", [case for case in STAND_INS if "pack" in STAND_INS[case][1]])
def test_a_packed_file_is_named_by_its_kind_under_its_own_suffix_too(tmp_path: Path, case: str) -> None:
    path = tmp_path / "takes.zip"
    path.write_bytes(STAND_INS[case][0])
    with pytest.raises(StudioError, match="Unpack it"):
        load_capture(path)


def test_a_project_that_is_only_a_pointer_is_named_so(tmp_path: Path) -> None:
    path = tmp_path / "scene.studio"
    path.write_bytes(POINTER)
    with pytest.raises(StudioError, match="is a Git LFS pointer"):
        read_project(path)
