"""Sound tracks: their waveform and beats on the timeline, to which contacts and keys snap."""

import os
import struct
import wave

import numpy as np
import pytest
from PySide6.QtCore import QPoint

from studio.app.verbs.media import add_sound
from studio.core.errors import StudioError
from studio.core.stage.beats import beats_of
from studio.core.stage.sound_track import SoundTrack
from studio.io.child_process import child_process, wait_for
from studio.io.media import sound_file
from studio.io.media.sound_file import read_samples, read_sound
from studio.io.project.project_file import new_document_id, read_project, write_project
from tests.patience import PATIENCE

RATE = 22_050
FRAME = 1 / 60


def clicks(times, seconds, pitch=900.0, noise=0.0, seed=0):
    """Mono samples with a short tone that dies away at each of the times."""
    place = np.arange(round(seconds * RATE)) / RATE
    samples = noise * np.random.default_rng(seed).standard_normal(len(place))
    for time in times:
        since = place - time
        samples += np.where(since >= 0, np.exp(-30 * np.maximum(since, 0)) * np.sin(2 * np.pi * pitch * since), 0.0)
    return samples


def write_wave(path, samples):
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes((np.clip(samples / max(np.abs(samples).max(), 1e-9), -1, 1) * 32000).astype("<i2").tobytes())
    return path


@pytest.mark.parametrize("pitch", [80.0, 440.0, 3000.0])
@pytest.mark.parametrize("times", [(0.0, 0.5, 1.0, 1.5), (0.31, 0.55, 1.9), (0.4, 2.2, 2.37, 2.54)])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_beats_are_found_within_a_frame_of_where_the_sound_sets_in(pitch, times, noise):
    found = beats_of(clicks(times, 3.0, pitch, noise), RATE)
    assert len(found) == len(times)
    assert np.abs(found - times).max() < FRAME


def test_silence_and_an_even_tone_have_no_beats_within_them():
    assert len(beats_of(np.zeros(RATE), RATE)) == 0
    assert len(beats_of(np.empty(0), RATE)) == 0
    tone = np.sin(2 * np.pi * 220 * np.arange(3 * RATE) / RATE)
    assert (beats_of(tone, RATE) < 0.05).all()


def test_a_file_becomes_a_waveform_and_its_beats(tmp_path):
    sound = read_sound(write_wave(tmp_path / "steps.wav", clicks((0.5, 1.25), 2.0)))
    assert sound.name == "steps"
    assert len(sound.peaks) == pytest.approx(200, abs=2)
    assert max(sound.peaks) == 255
    assert np.argmax(sound.peaks) in (50, 51, 125, 126)
    assert sound.beats == pytest.approx((0.5, 1.25), abs=FRAME)


def test_values_that_are_no_numbers_are_silence_between_the_beats(tmp_path):
    samples = clicks((0.5, 1.25), 2.0).astype("<f4")
    samples[[100, 20_000, 30_000]] = np.inf, np.nan, -np.inf
    head = struct.pack(
        "<4sI4s4sIHHIIHH4sI",
        b"RIFF",
        36 + samples.nbytes,
        b"WAVE",
        b"fmt ",
        16,
        3,
        1,
        RATE,
        4 * RATE,
        4,
        32,
        b"data",
        samples.nbytes,
    )
    path = tmp_path / "steps.wav"
    path.write_bytes(head + samples.tobytes())
    sound = read_sound(path)
    assert sound.beats == pytest.approx((0.5, 1.25), abs=FRAME)
    assert sum(peak > 20 for peak in sound.peaks) > 10


def test_a_sound_that_could_not_be_decoded_whole_ends_with_its_last_whole_sample(tmp_path, monkeypatch):
    path = write_wave(tmp_path / "steps.wav", clicks((0.5,), 1.0))

    def cut_off(process, alive):
        code = wait_for(process, alive)
        os.truncate(f"/proc/self/fd/{decoded_files[-1]}", 1003)
        return code

    decoded_files = []

    def recorded(command, stdin, stdout, stderr):
        decoded_files.append(stdout.fileno())
        return child_process(command, stdin, stdout, stderr)

    monkeypatch.setattr(sound_file, "wait_for", cut_off)
    monkeypatch.setattr(sound_file, "child_process", recorded)
    assert len(read_samples(path)) == 250
    assert len(read_sound(path).peaks) == 3


def test_a_file_without_sound_is_a_sentence(tmp_path):
    path = tmp_path / "notes.wav"
    path.write_text("no sound", encoding="utf-8")
    with pytest.raises(StudioError, match=r"notes\.wav has no sound"):
        read_sound(path)
    with pytest.raises(StudioError, match="not there any more"):
        read_sound(tmp_path / "gone.wav")


@pytest.mark.parametrize("wrong", [{"peaks": ()}, {"peaks": (1, 256)}, {"beats": (1.0, 0.5)}, {"start": float("nan")}])
def test_a_track_that_cannot_be_is_refused(wrong):
    with pytest.raises(ValueError, match="sound 'Steps'"):
        SoundTrack(**{"name": "Steps", "source": "steps.wav", "peaks": (0, 255), **wrong})


def test_a_sound_is_added_shown_written_and_undone(qtbot, window, tmp_path):
    document = window.bench.document
    add_sound(window.bench, write_wave(tmp_path / "steps.wav", clicks((0.5,), 1.0)))
    qtbot.waitUntil(lambda: bool(document.project.sounds), timeout=PATIENCE)
    path = tmp_path / "stage.studio"
    write_project(path, document.project, new_document_id())
    assert dict(read_project(path).project.sounds) == dict(document.project.sounds)
    assert document.selection.current[0] == "sounds"
    document.undo_stack.undo()
    assert not document.project.sounds


def test_an_end_of_a_contact_snaps_to_a_beat(timeline, document, hand):
    beat = 17.3 / 60.0
    document.add("sounds", SoundTrack("Steps", "steps.wav", (0, 255) * 60, (0.1,), beat - 0.1), "Add sound")
    bar = timeline.contact_rect("early")
    target = timeline.x_of_frame(17.3)
    begin = QPoint(bar.right() - 1, bar.center().y())
    hand.press(begin)
    hand.move(round(target) + 2 - begin.x())
    mark = hand.rows.gesture.mark
    hand.release()
    assert mark.magnet == pytest.approx(beat)
    assert document.project.contacts["early"].last == 17


def test_a_sound_is_dragged_to_another_time_as_one_undo_step(timeline, document, hand):
    sound_id = document.add("sounds", SoundTrack("Steps", "steps.wav", (0, 255) * 60, (0.1,)), "Add sound")
    row = timeline.row_rect("sounds", sound_id)
    y = row.center().y()
    begin = round(timeline.x_of_frame(10))
    hand.drag(QPoint(begin, y), round(timeline.x_of_frame(30) - timeline.x_of_frame(10)))
    assert document.project.sounds[sound_id].start == pytest.approx(20 / 60, abs=1.5 / 60)
    document.undo_stack.undo()
    assert document.project.sounds[sound_id].start == 0.0
