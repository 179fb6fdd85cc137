"""Each example script runs, prints what it says, and leaves the files that it names."""

from pathlib import Path

import pytest

from studio.cli.main import main
from studio.io.importing import load_capture
from studio.resources_folder import example_captures_folder

SCRIPTS = Path(__file__).resolve().parents[2] / "examples" / "scripts"
MOST_LINES = 60


def run(name: str, *arguments: Path | str) -> None:
    """Run an example as a user does."""
    assert main(["script", str(SCRIPTS / f"{name}.py"), *map(str, arguments)]) == 0


def test_a_capture_is_adapted_to_three_bodies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run("adapt_capture", tmp_path)
    written = [Path(line) for line in capsys.readouterr().out.splitlines()]
    assert len(written) == 3
    assert len({round(load_capture(path).skeleton.offsets[1:, 2].sum(), 6) for path in written}) == 3


def test_a_reach_reports_who_misses_the_place(capsys: pytest.CaptureFixture[str]) -> None:
    run("reach_a_place")
    child, giant = capsys.readouterr().out.splitlines()
    assert child.startswith("Child")
    assert giant.startswith("Giant: 0.")


def test_a_planted_foot_moves_the_ankle(capsys: pytest.CaptureFixture[str]) -> None:
    run("plant_a_foot")
    assert float(capsys.readouterr().out.split()[5]) > 1.0


def test_a_table_has_a_row_for_each_capture_and_body(tmp_path: Path) -> None:
    run("report_slides", tmp_path / "slides.csv")
    rows = (tmp_path / "slides.csv").read_text().splitlines()
    assert len(rows) == 1 + 2 * len(list(example_captures_folder().glob("*.bvh")))


def test_a_search_finds_three_strikes_for_each_body(capsys: pytest.CaptureFixture[str]) -> None:
    run("search_a_strike")
    assert [line.split(":")[0] for line in capsys.readouterr().out.splitlines()] == ["child"] * 3 + ["giant"] * 3


def test_a_hand_stays_on_the_shoulder_of_another_performer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run("follow_a_hand", tmp_path)
    assert float(capsys.readouterr().out.split()[0]) < 1.0
    assert len(list(tmp_path.glob("*.bvh"))) == 2


def test_a_folder_is_adapted_past_a_broken_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "captures"
    folder.mkdir()
    (folder / "broken.bvh").write_text("no motion")
    (folder / "kick.bvh").write_bytes((example_captures_folder() / "front_kick.bvh").read_bytes())
    run("batch_folder", folder, tmp_path / "out")
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith("broken.bvh: ")
    assert Path(second).exists()


def test_a_scene_is_drawn(tmp_path: Path) -> None:
    run("render_a_scene", tmp_path / "walk.png")
    assert (tmp_path / "walk.png").stat().st_size > 10_000


def test_joined_clips_are_saved_and_opened_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run("join_clips", tmp_path / "row.studio")
    assert float(capsys.readouterr().out.split()[3]) > 5.0
    run("render_a_scene", tmp_path / "row.png", tmp_path / "row.studio", "1.0")


def test_a_hand_slides_along_a_banister_while_the_head_faces_as_the_hips(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run("rail_and_parallel", tmp_path / "slide.bvh")
    words = capsys.readouterr().out.split()
    assert float(words[3]) <= 0.2
    assert float(words[10]) <= 0.1
    assert (tmp_path / "slide.bvh").exists()


def test_swapped_priorities_change_which_constraint_is_met(capsys: pytest.CaptureFixture[str]) -> None:
    run("compare_residuals")
    first, second = capsys.readouterr().out.splitlines()
    assert "'Right hand high': '0." in first
    assert "'Left hand low': '0." in second
    assert first != second


@pytest.mark.parametrize("content", [b"PK\3\4", b"PK\0\0", bytes(range(128, 256)), b"if True\n"])
def test_a_file_that_is_no_python_is_named_in_a_sentence(content: bytes, tmp_path, capsys) -> None:
    (tmp_path / "half.studio").write_bytes(content)
    assert main(["script", str(tmp_path / "half.studio")]) == 1
    [sentence] = capsys.readouterr().err.splitlines()
    assert "half.studio' is not a Python script: " in sentence


@pytest.mark.parametrize(
    ("ending", "code", "said"), [("'No capture.'", 1, "No capture.\n"), ("3", 3, ""), ("None", 0, ""), ("", 0, "")]
)
def test_a_script_ends_with_its_own_words_and_exit_code(ending: str, code: int, said: str, tmp_path, capsys) -> None:
    (tmp_path / "mine.py").write_text(f"import sys; sys.exit({ending})", encoding="utf-8")
    assert main(["script", str(tmp_path / "mine.py")]) == code
    assert capsys.readouterr().err == said


@pytest.mark.parametrize("script", sorted(SCRIPTS.glob("*.py")), ids=lambda path: path.stem)
def test_an_example_is_short_and_says_how_it_is_run(script: Path) -> None:
    text = script.read_text()
    assert len(text.splitlines()) <= MOST_LINES
    assert f"morpho-studio script examples/scripts/{script.name}" in text
