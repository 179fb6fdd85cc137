import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.app.import_corrections import with_corrections
from studio.core.errors import StudioError
from studio.io.export import write_capture
from studio.io.importing import ImportOptions, load_capture, read_capture
from tests.builders import make_capture

GUESS_ALL = ImportOptions()


def silent(_share: float, _text: str) -> None:
    pass


def corrected(path: Path, reference: str) -> dict[str, dict[str, object]]:
    """Options kept, as JSON has them, when the user reads a file otherwise."""
    read_as = with_corrections(read_capture(path), GUESS_ALL, {}, silent)[1]
    said = ImportOptions(reference=reference)
    kept = {read_as.kind: replace(read_as, options=said).corrections(load_capture(path, said))}
    return json.loads(json.dumps(kept))


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    write_capture(make_capture(), tmp_path / "walk.bvh")
    return tmp_path / "walk.bvh"


@pytest.fixture
def other(tmp_path: Path) -> Path:
    write_capture(make_capture(frames=12), tmp_path / "other.bvh")
    return tmp_path / "other.bvh"


def test_a_reference_pose_that_was_a_frame_is_the_same_pose_in_a_shorter_file_of_its_kind(walk, other) -> None:
    kept = corrected(walk, reference="20")
    again, read_as = with_corrections(read_capture(other), GUESS_ALL, kept, silent)
    assert np.abs(again.reference_rotations - load_capture(walk).poses.local_rotations[20]).max() < 1e-12
    assert "reference pose" not in {guess.subject for guess in again.guesses}
    assert read_as.corrections(again) == kept[read_as.kind]


@pytest.mark.parametrize("which", ["zero", "0"])
def test_the_zero_pose_and_frame_0_are_those_of_every_file(walk, other, which: str) -> None:
    kept = corrected(walk, reference=which)
    assert [*kept.values()] == [{"reference": which}]
    again, _ = with_corrections(read_capture(other), GUESS_ALL, kept, silent)
    assert np.array_equal(
        again.reference_rotations, load_capture(other, ImportOptions(reference=which)).reference_rotations
    )


@pytest.mark.parametrize(
    ("pose", "sentence"),
    [
        ({"Nose": [0, 0, 0, 1]}, "a joint 'Nose' that the file does not have"),
        ({"Hips": [0, 0, 0]}, "'Hips' by something that is not a quaternion"),
        ({"Hips": [0, 0, 0, 0]}, "'Hips' by something that is not a quaternion"),
        ({"Hips": [float("nan"), 0, 0, 1]}, "'Hips' by something that is not a quaternion"),
    ],
)
def test_a_reference_pose_that_does_not_fit_is_refused_in_a_sentence(walk, pose, sentence: str) -> None:
    with pytest.raises(StudioError, match=sentence):
        load_capture(walk, ImportOptions(reference=pose))


def test_a_reference_frame_of_one_strike_holds_for_the_next_of_the_same_actor(captures: Path) -> None:
    first, second = (captures / f"bvh/strikes/accad_male2_{name}.bvh" for name in ("E1_JabLeft", "G2_FrontKick"))
    kept = corrected(first, reference="30")
    again, _ = with_corrections(read_capture(second), GUESS_ALL, kept, silent)
    assert np.abs(again.reference_rotations - load_capture(first).poses.local_rotations[30]).max() < 1e-12
