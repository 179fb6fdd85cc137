import io
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from studio.cli import example
from studio.cli import main as main_module
from studio.core.errors import StudioError
from studio.startup import process, system_libraries
from studio.startup.process import content_digest, has_display, kernel_cache_folder, writable_kernel_cache


def test_the_kernel_cache_changes_with_the_content_of_any_kernel(tmp_path):
    kernel, other = tmp_path / "rotations.py", tmp_path / "chains.py"
    kernel.write_text("a = 1\n")
    other.write_text("b = 1\n")
    before = content_digest([kernel, other])
    assert content_digest([kernel, other]) == before
    other.write_text("b = 2\n")
    assert content_digest([kernel, other]) != before


def test_a_checkout_that_is_copied_has_a_kernel_cache_of_its_own(tmp_path, monkeypatch):
    copy = shutil.copytree(process.KERNELS_FOLDER, tmp_path / "kernels", ignore=shutil.ignore_patterns("__pycache__"))
    here = kernel_cache_folder()
    monkeypatch.setattr(process, "KERNELS_FOLDER", copy)
    assert kernel_cache_folder() != here


def test_a_home_that_cannot_be_written_still_gets_a_kernel_cache(tmp_path, monkeypatch):
    monkeypatch.setattr(
        "studio.startup.process.platformdirs.user_cache_dir", lambda *_, **__: str(tmp_path / "in_the_way")
    )
    (tmp_path / "in_the_way").write_text("a file where a folder should be")
    monkeypatch.setattr("studio.startup.process.tempfile.tempdir", str(tmp_path))
    cache = writable_kernel_cache()
    assert cache.is_dir()
    assert cache != kernel_cache_folder()
    assert writable_kernel_cache() == cache  # the same for the next process
    assert [each.name for each in tmp_path.iterdir() if each.is_dir()] == [cache.parent.name]


def test_kernels_that_cannot_be_stored_are_used_and_that_is_said_once(tmp_path):
    """A full disk ended every verb with a traceback of numba."""
    pytest.importorskip("resource")
    script = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
import numpy as np
from studio.io.numbers import table
for lines in [b"1 2"], [b"1 x"]:
    try:
        print(table(lines, np.array([2]), "take.bvh", 1, lambda _share: None).tolist())
    except Exception as error:
        print(type(error).__name__)
"""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True)
    assert done.stdout.splitlines() == ["[1.0, 2.0]", "StudioError"]
    assert done.stderr.count("cannot be stored") == 1


@pytest.mark.parametrize("taken", ["open to others", "a link"])
def test_a_temporary_cache_that_others_may_write_to_is_not_used(tmp_path, monkeypatch, taken):
    """numba runs what it finds there."""
    monkeypatch.setattr("studio.startup.process.tempfile.tempdir", str(tmp_path))
    shared = tmp_path / f"morpho-studio-kernels-{os.getuid()}"
    if taken == "a link":
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        shared.symlink_to(tmp_path / "elsewhere")
    else:
        shared.mkdir()
        shared.chmod(0o777)
    cache = process.temporary_kernel_cache("kernels")
    assert cache.parent == tmp_path
    assert cache not in (shared, tmp_path / "elsewhere")
    assert not any((tmp_path / "elsewhere").glob("*"))


def test_where_users_have_no_number_the_temporary_cache_is_of_this_process_alone(monkeypatch) -> None:
    monkeypatch.delattr(process.os, "getuid")
    first, second = process.temporary_kernel_cache("kernels"), process.temporary_kernel_cache("kernels")
    assert first.is_dir()
    assert first != second


def test_a_folder_made_for_one_process_is_gone_with_it(tmp_path):
    (tmp_path / f"morpho-studio-kernels-{os.getuid()}").write_text("a file where a folder should be")
    script = (
        "from studio.startup.process import temporary_kernel_cache; print(temporary_kernel_cache('kernels').is_dir())"
    )
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    done = subprocess.run((sys.executable, "-c", script), capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.strip() == "True"
    assert len([*tmp_path.iterdir()]) == 1


@pytest.mark.parametrize("home_is_writable", [True, False])
def test_only_the_caches_that_were_used_last_are_kept(tmp_path, monkeypatch, home_is_writable):
    home = tmp_path / "home"
    if not home_is_writable:
        home.write_text("a file where a folder should be")
    monkeypatch.setattr("studio.startup.process.platformdirs.user_cache_dir", lambda *_, **__: str(home))
    monkeypatch.setattr("studio.startup.process.tempfile.tempdir", str(tmp_path))
    here = writable_kernel_cache()
    for age in range(process.MOST_CACHES + 4):
        old = here.parent / f"old-{age}"
        old.mkdir()
        (old / "kernel.nbc").touch()
        os.utime(old, (1e9 - age, 1e9 - age))
    os.utime(here, (1.0, 1.0))
    assert writable_kernel_cache() == here  # it is used now
    left = {each.name for each in here.parent.iterdir()}
    assert left == {here.name, *(f"old-{age}" for age in range(process.MOST_CACHES - 1))}


@pytest.mark.parametrize("what", ["processor", "version"])
def test_another_processor_python_or_numba_has_a_cache_of_its_own(monkeypatch, what):
    """A cache that is complete for one holds nothing that another can use."""
    here = kernel_cache_folder()
    monkeypatch.setattr(process, what, lambda *_: "another")
    assert kernel_cache_folder() != here


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere a display is taken for granted")
@pytest.mark.parametrize(
    ("variables", "seen"),
    [
        ({}, False),
        ({"DISPLAY": ":0"}, True),
        ({"WAYLAND_DISPLAY": "wayland-0"}, True),
        ({"DISPLAY": ""}, False),
    ],
)
def test_a_display_is_x_or_wayland(monkeypatch, variables, seen):
    monkeypatch.setattr(os, "environ", dict(variables))
    assert has_display() is seen


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="elsewhere the system's allocator is left as it is")
def test_the_memory_of_a_solved_clip_serves_the_next_one():
    """Freed memory is handed out again: the system need not bring and clear the same pages for every clip."""
    script = """
import resource
import numpy as np
from studio.startup.process import keep_freed_memory
def faults_of_rounds(count):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(count):
        clips = [np.ones(240_000) for _ in range(6)]
        del clips
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before
keep_freed_memory()
faults_of_rounds(2)
print(faults_of_rounds(10))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 1000  # of 28,000 pages


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="elsewhere the system's allocator is left as it is")
def test_what_one_thread_has_freed_serves_the_others():
    """Twelve threads that need 24 MB one after the other do not keep 24 MB each."""
    script = """
import os
import threading
import numpy as np
from studio.startup.process import keep_freed_memory
def resident():
    return int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
keep_freed_memory()
turn, done = threading.Lock(), threading.Barrier(13)
def work():
    with turn:
        clips = [np.ones(500_000) for _ in range(6)]
        del clips
    done.wait()
    done.wait()
before = resident()
for _ in range(12):
    threading.Thread(target=work).start()
done.wait()
print(resident() - before)
done.wait()
"""
    command = [sys.executable, "-W", "ignore::ResourceWarning", "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert int(done.stdout) < 100e6


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="elsewhere the system's allocator is left as it is")
def test_what_was_freed_between_things_in_use_is_given_back():
    script = """
import os
from studio.startup.process import give_back_freed_memory, keep_freed_memory
def resident():
    return int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
keep_freed_memory()
before = resident()
pieces = [bytearray(10_000) for _ in range(10_000)]
pieces = pieces[::100]
kept = resident() - before
give_back_freed_memory()
print(kept, resident() - before)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    kept, left = map(int, done.stdout.split())
    assert kept > 80e6
    assert left < 10e6


@pytest.fixture
def bare(monkeypatch):
    """A system without the library that Qt and VTK draw with."""
    monkeypatch.setitem(system_libraries.DRAWING_LIBRARIES, "libEGL-missing.so.1", "libegl1")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="libraries of Linux")
@pytest.mark.parametrize(
    ("user", "programs", "advice"),
    [
        (0, {"apt-get", "sudo"}, "Type: apt-get update && apt-get install -y libegl1"),
        (1000, {"apt-get", "sudo"}, "Type: sudo sh -c 'apt-get update && apt-get install -y libegl1'"),
        (1000, {"apt-get"}, "Type: su -c 'apt-get update && apt-get install -y libegl1'"),
        (1000, {"dnf"}, "Install what your system has for Debian's packages libegl1."),
    ],
)
def test_a_missing_library_is_one_sentence_with_what_this_user_can_type(bare, monkeypatch, user, programs, advice):
    monkeypatch.setattr("os.geteuid", lambda: user)
    monkeypatch.setattr("shutil.which", lambda name: name if name in programs else None)
    monkeypatch.setattr(system_libraries, "missing_packages", lambda: ["libegl1"])
    with pytest.raises(StudioError) as raised:
        process.check_libraries(window=True)
    assert str(raised.value) == f"System libraries are missing: libEGL-missing.so.1. {advice}"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="libraries of Linux")
def test_what_is_to_be_typed_is_all_that_pictures_and_a_window_take_and_each_once(monkeypatch):
    monkeypatch.setattr(system_libraries, "_loads", lambda name: False)
    needed = {
        **system_libraries.DRAWING_LIBRARIES,
        **system_libraries.WINDOW_LIBRARIES,
        **system_libraries.OPTIONAL_LIBRARIES,
    }
    packages = system_libraries.missing_packages()
    assert set(needed.values()) <= set(packages)
    assert len(packages) == len(set(packages))
    assert " ".join(packages) in system_libraries.sentence_about(system_libraries.DRAWING_LIBRARIES)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="libraries of Linux")
def test_the_window_and_pictures_are_refused_before_qt_or_vtk_is_asked(bare, monkeypatch, capsys, tmp_path):
    monkeypatch.setenv("DISPLAY", ":99")
    monkeypatch.setattr(main_module, "entry_points", lambda **_: pytest.fail("Qt would end the process"))
    for arguments in ([], ["render", "walk.bvh", "--out", str(tmp_path / "walk.png")]):
        assert main_module.main(arguments) == 1
        assert "libegl1" in capsys.readouterr().err


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="libraries of Linux")
def test_without_a_display_the_example_is_adapted_and_what_is_missing_told(bare, monkeypatch, capsys, tmp_path):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)
    assert main_module.main([]) == 0
    assert "libegl1" in capsys.readouterr().out
    assert list(tmp_path.rglob("*.bvh"))


def test_that_there_is_no_display_is_said_before_anything_is_compiled(monkeypatch):
    """In a pipe too, which is written to when a page is full."""
    pipe, seen = io.BytesIO(), []
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(pipe))
    monkeypatch.setattr(example, "main", lambda _arguments: seen.append(pipe.getvalue()) or 0)
    example.run_example()
    assert seen[0].startswith(b"There is no display")


def test_what_looks_for_libraries_needs_nothing_but_python():
    script = Path(process.__file__).with_name("system_libraries.py")
    done = subprocess.run((sys.executable, "-I", "-S", str(script)), capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
