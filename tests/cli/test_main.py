import json
import os
import shutil
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

import studio.cli.main as command_line
from studio.cli.arguments import ADD_ARGUMENTS
from studio.core.errors import StudioError


@pytest.fixture
def verb_that(monkeypatch):
    """Puts a verb with the given deed in the place of `info`."""

    def install(deed):
        verb = ModuleType("studio.cli.info")
        verb.run = deed
        monkeypatch.setitem(sys.modules, "studio.cli.info", verb)
        monkeypatch.setitem(ADD_ARGUMENTS, "info", lambda parser: parser.add_argument("--json", action="store_true"))

    return install


def fail(_arguments):
    raise StudioError("The file 'walk.bvh' is empty. Choose another.")


def test_the_exit_code_is_the_verbs_own(verb_that):
    verb_that(lambda _arguments: 0)
    assert command_line.main(["info"]) == 0
    verb_that(lambda _arguments: 1)
    assert command_line.main(["info"]) == 1


def test_a_failure_is_one_sentence_on_standard_error(verb_that, capsys):
    verb_that(fail)
    assert command_line.main(["info"]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == "morpho-studio: The file 'walk.bvh' is empty. Choose another.\n"


def test_a_failure_for_a_machine_is_one_json_document(verb_that, capsys):
    verb_that(fail)
    assert command_line.main(["info", "--json"]) == 1
    printed = capsys.readouterr()
    assert json.loads(printed.out) == {"ok": False, "error": "The file 'walk.bvh' is empty. Choose another."}
    assert printed.err == ""


def be_stopped(_arguments):
    raise KeyboardInterrupt


def test_ctrl_c_ends_any_verb_with_one_sentence(verb_that, capsys):
    verb_that(be_stopped)
    assert command_line.main(["info"]) == 130
    printed = capsys.readouterr()
    assert printed.err == "morpho-studio: Stopped. No file was left incomplete.\n"
    assert command_line.main(["info", "--json"]) == 130
    assert json.loads(capsys.readouterr().out)["ok"] is False


def test_a_fault_of_the_program_is_not_dressed_up_as_the_users(verb_that):
    verb_that(lambda _arguments: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        command_line.main(["info"])


@pytest.mark.parametrize("arguments", [["nonsense"], ["--nonsense"]])
def test_bad_usage_ends_with_two(arguments, capsys):
    with pytest.raises(SystemExit) as end:
        command_line.main(arguments)
    assert end.value.code == 2
    assert "usage:" in capsys.readouterr().err


def test_help_names_every_verb(capsys):
    with pytest.raises(SystemExit) as end:
        command_line.main(["--help"])
    assert end.value.code == 0
    printed = capsys.readouterr().out
    assert all(verb in printed for verb in command_line.VERBS)


def test_without_a_verb_the_window_opens_where_there_is_a_display(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    begun = []
    monkeypatch.setattr("studio.startup.kernel_warm_up.WarmUp", lambda held: begun.append(held))
    window = SimpleNamespace(load=lambda: lambda _files, _warm_up: 7 if begun == [True] else 0)
    monkeypatch.setattr(command_line, "entry_points", lambda **_wanted: [window])
    assert command_line.main([]) == 7


def test_a_studio_without_a_window_says_how_to_get_one(monkeypatch, capsys):
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(command_line, "entry_points", lambda **_wanted: [])
    assert command_line.main([]) == 1
    assert "pip install" in capsys.readouterr().err


def test_the_window_is_declared_where_the_command_line_looks_for_it():
    [window] = entry_points(group="morpho_studio.window", name="main")
    assert window.value == "studio.app.application:main"


def test_files_named_without_a_verb_are_opened_in_the_window(monkeypatch):
    opened = []
    monkeypatch.setattr(command_line, "has_display", lambda: True)
    monkeypatch.setattr(command_line, "open_window", lambda files: opened.append(files) or 0)
    assert command_line.main(["walk.bvh", "Kick.STUDIO"]) == 0
    assert command_line.main([]) == 0
    assert opened == [["walk.bvh", "Kick.STUDIO"], []]


def test_files_cannot_be_opened_without_a_display_and_that_is_said(monkeypatch, capsys):
    monkeypatch.setattr(command_line, "has_display", lambda: False)
    assert command_line.main(["walk.bvh"]) == 1
    assert "No display is available to open walk.bvh" in capsys.readouterr().err


def test_a_reader_that_has_seen_enough_is_no_fault():
    reading, writing = os.pipe()
    os.close(reading)
    start = "import sys; from studio.cli.main import main; sys.exit(main(['formats']))"
    with os.fdopen(writing, "wb") as closed:
        done = subprocess.run([sys.executable, "-c", start], stdout=closed, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.parametrize("arguments", [["formats"], ["formats", "--json"]])
def test_an_output_without_room_is_a_sentence(arguments):
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    start = f"import sys; from studio.cli.main import main; sys.exit(main({arguments}))"
    with open("/dev/full", "wb") as full:
        done = subprocess.run([sys.executable, "-c", start], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1
    [sentence] = done.stderr.splitlines()
    assert sentence.startswith("morpho-studio: The output could not be written: No space left on device.")


@pytest.mark.parametrize(
    "arguments",
    [
        ["info", "x" * 5000],
        ["convert", "examples/captures/reach_grasp.bvh", f"{'x' * 300}/out.bvh"],
        ["adapt", "--stage", "a-clap", "--out", "x" * 5000],
        ["render", "a-clap", "--out", f"{'x' * 300}.png"],
        ["script", "x" * 5000],
    ],
)
def test_a_name_that_no_system_allows_is_a_sentence(arguments, capsys):
    assert command_line.main(arguments) == 1
    printed = capsys.readouterr().err
    assert "File name too long" in printed
    assert len(printed) < 600


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere every name of a file is text")
def test_a_capture_whose_name_is_no_text_is_read_and_written_like_any_other(tmp_path, capsys):
    folder = tmp_path / os.fsdecode(b"\xfcbungen")
    folder.mkdir()
    capture = folder / os.fsdecode(b"gr\xfc\xdfe.bvh")
    shutil.copyfile("examples/captures/reach_grasp.bvh", capture)
    command = [sys.executable, "main.py", "info", str(capture)]
    done = subprocess.run(command, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode(errors="replace")
    sys.stderr.reconfigure(errors="backslashreplace")  # as that of a process is
    for arguments in (
        ["convert", capture, folder / "out.bvh"],
        ["convert", capture, folder / "out.s4d"],
        ["convert", capture, folder / "out.glb"],
        ["adapt", capture, "--character", "child", "--out", folder / "adapted"],
        ["batch", folder, "--character", "child", "--out", tmp_path / "many", "--workers", "1"],
    ):
        assert command_line.main([*map(str, arguments)]) == 0, capsys.readouterr().err
    report = json.loads((folder / "adapted" / "report.json").read_text(encoding="utf-8"))
    assert report["source"] == str(capture)
