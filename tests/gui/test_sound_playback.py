"""Sounds are heard where the playhead is, whatever the device's own clock does; the device of the tests is silent."""

import sys
import time

import numpy as np
import pytest

from studio.app import relinking
from studio.app.sound_playback import SCRUB_SECONDS
from studio.app.verbs.media import add_sound
from studio.core.stage.playback_run import PlaybackRun
from studio.io.media import sound_output
from studio.io.media.sound_file import read_samples
from studio.io.media.sound_output import (
    DEVICE_PERIODS,
    HEARD_RATE,
    LOST_SECONDS,
    MOST_STRETCH,
    PERIOD_MILLISECONDS,
    HeardSound,
    SoundOutput,
    StreamClock,
    mix,
)
from tests.gui.test_sound_tracks import clicks, write_wave
from tests.patience import PATIENCE

FRAME = 1 / 60
PIECE = HEARD_RATE * PERIOD_MILLISECONDS // 1000


def heard_clock(seconds, rate_error=0.0, jitter=0.0, stall=None, seed=0):
    """(P,) clock seconds at which a device of another rate plays each piece, and those the stream takes them for.

    The device has ``DEVICE_PERIODS`` pieces at hand and asks for the next when one is played, up to ``jitter`` seconds
    late; at second ``stall`` it is answered half a second late.
    """
    generator, stream = np.random.default_rng(seed), StreamClock()
    duration = PIECE / HEARD_RATE / (1.0 + rate_error)
    played, taken = [], []
    begin = 100.0
    for piece in range(int(seconds / duration)):
        asked = begin + max(piece - DEVICE_PERIODS + 1, 0) * duration
        now = asked + jitter * generator.random()
        if stall is not None and piece == int(stall / duration):
            now += 0.5
            begin += 0.5
        taken.append(stream.advance(now, PIECE)[0])
        played.append(begin + piece * duration)
    return np.array(played), np.array(taken)


@pytest.mark.parametrize("rate_error", [-3e-4, 0.0, 3e-4])
@pytest.mark.parametrize("jitter", [0.0, 0.02])
def test_over_ten_minutes_the_sound_drifts_by_less_than_a_frame_whatever_the_clock_of_the_device(rate_error, jitter):
    played, taken = heard_clock(600.0, rate_error, jitter)
    assert np.abs(played - taken).max() < FRAME
    free = 600.0 * rate_error  # as far as the device is off by itself
    assert rate_error == 0.0 or abs(free) > 5 * FRAME


def test_after_a_stall_the_sound_is_in_step_again():
    played, taken = heard_clock(60.0, stall=30.0)
    assert np.abs(played - taken)[-500:].max() < FRAME


def test_the_sound_is_never_stretched_by_more_than_half_a_percent():
    stream = StreamClock()
    for piece in range(100):
        stream.advance(piece * PIECE / HEARD_RATE, PIECE)
    late = stream.advance(100 * PIECE / HEARD_RATE + 0.9 * LOST_SECONDS, PIECE)
    assert np.diff(late) == pytest.approx((1 + MOST_STRETCH) / HEARD_RATE, rel=0.01)


def test_samples_lie_where_the_stage_has_them_and_outside_is_silence():
    ramp = np.repeat(np.arange(0, 20_000, 2, dtype=np.int16)[:, None], 2, axis=1)
    sound = HeardSound(ramp, start=1.0)
    seconds = np.array([0.5, 1.0, 1.0 + 100.5 / HEARD_RATE, np.nan, 1.0 + 20_000 / HEARD_RATE])
    mixed = mix([sound], seconds)
    assert mixed.shape == (5, 2)
    assert mixed[:, 0] * 32768 == pytest.approx([0, 0, 201, 0, 0], abs=0.01)
    assert mix([sound, sound], seconds)[2] == pytest.approx(2 * mixed[2])
    assert not mix([], seconds).any()


@pytest.mark.parametrize("speed", [1.0, 0.25, 8.0, -1.0])
def test_a_run_of_any_speed_loops_at_the_end_of_its_range(speed):
    run = PlaybackRun(100.0, 2.0, speed, begin=2.0, end=2.9, frame=0.1, loop=True)
    clock = 100.0 + np.arange(0.0, 5.0, 0.01) / abs(speed)
    seconds = run.stage_seconds(clock)
    off = seconds - 2.0 - np.sign(speed) * np.arange(0.0, 5.0, 0.01)
    assert np.abs((off + 0.5) % 1.0 - 0.5).max() < 1e-6
    assert seconds.min() >= 2.0
    assert seconds.max() <= 3.0
    ending = PlaybackRun(100.0, 2.0, speed, begin=2.0, end=2.9, frame=0.1, loop=False)
    assert np.isnan(ending.stage_seconds(clock[1:])).any()


class Output:
    """Output that keeps what it is to play."""

    def __init__(self):
        self.played = None

    def play(self, run, sounds):
        self.played = run, tuple(sounds)

    def pause(self):
        self.played = None

    def close(self):
        pass


@pytest.fixture
def heard(qtbot, window, tmp_path):
    """The window with a sound of two seconds that is read, and what it plays."""
    window.sound_playback.close()
    add_sound(window.bench, write_wave(tmp_path / "steps.wav", clicks((0.5,), 2.0)))
    qtbot.waitUntil(lambda: bool(window.bench.document.project.sounds), timeout=PATIENCE)
    playback = window.sound_playback
    playback.output = Output()
    playhead = window.bench.document.playhead
    playhead.set_time(0.1)
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)
    return window, playback, playhead


def test_the_sound_follows_play_pause_a_drag_speed_and_mute(heard):
    window, playback, playhead = heard
    playhead.set_time(0.5)
    run, [sound] = playback.output.played
    assert (run.begin, run.end, run.loop) == (0.5, 0.5 + SCRUB_SECONDS, False)
    assert len(sound.samples) == pytest.approx(2 * HEARD_RATE, abs=10)
    playhead.speed = 2.0
    playhead.play()
    assert playback.output.played[0] == playhead.run
    assert playback.output.played[0].speed == 2.0
    window.actions_by_id.by_id["mute"].trigger()
    assert playback.output.played is None
    window.actions_by_id.by_id["mute"].trigger()
    assert playback.output.played is not None
    playhead.pause()
    assert playback.output.played is None


def test_a_sound_whose_file_has_moved_is_found_in_a_known_folder_else_relinked(heard, qtbot, tmp_path, monkeypatch):
    window, playback, playhead = heard
    document, file = window.bench.document, tmp_path / "steps.wav"
    (tmp_path / "sounds" / "far").mkdir(parents=True)
    moved = file.rename(tmp_path / "sounds" / "steps.wav")
    window.bench.settings.folder = moved.parent
    playback._samples.clear()
    playhead.set_time(0.7)
    qtbot.waitUntil(lambda: playback._samples[str(file)] is not None, timeout=PATIENCE)
    moved = moved.rename(moved.parent / "far" / "other.wav")
    playback._samples.clear()
    playhead.set_time(0.8)
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)
    assert window.strip.text == "The file steps.wav of steps cannot be found. Relink it."
    monkeypatch.setattr(relinking, "ask_file", lambda bench, title, kind, then: then(moved))
    window.strip.press("Relink…")
    [sound] = document.project.sounds.values()
    assert sound.source == str(moved)
    playhead.set_time(0.9)
    qtbot.waitUntil(lambda: playback._samples[str(moved)] is not None, timeout=PATIENCE)
    document.undo_stack.undo()
    assert [each.source for each in document.project.sounds.values()] == [str(file)]


def test_a_sound_is_heard_once_its_file_is_back_where_it_was_and_relinked_there(heard, qtbot, tmp_path, monkeypatch):
    window, playback, playhead = heard
    file = tmp_path / "steps.wav"
    away = file.rename(tmp_path / "away")
    playback._samples.clear()
    playhead.set_time(0.8)
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)
    away.rename(file)
    monkeypatch.setattr(relinking, "ask_file", lambda bench, title, kind, then: then(file))
    window.strip.press("Relink…")
    playhead.set_time(0.9)
    qtbot.waitUntil(lambda: playback._samples[str(file)] is not None, timeout=PATIENCE)


def output_of(tmp_path, backends, report=lambda sentence: None):
    samples = read_samples(write_wave(tmp_path / "steps.wav", clicks((0.0, 0.3), 1.0)))
    output = SoundOutput(report, backends=backends)
    now = time.monotonic()
    output.play(PlaybackRun(now, 0.0, 1.0, 0.0, 10.0, FRAME, True), [HeardSound(samples, 0.0)])
    return output


def test_a_silent_device_is_given_the_sound_of_the_stage_and_let_go_when_nothing_is_wanted(
    tmp_path, qtbot, monkeypatch
):
    pytest.importorskip("miniaudio")
    given = []
    monkeypatch.setattr(sound_output, "mix", lambda sounds, seconds: given.append(seconds) or mix(sounds, seconds))
    output = output_of(tmp_path, ("NULL",))
    qtbot.waitUntil(lambda: len(given) > DEVICE_PERIODS, timeout=PATIENCE)
    assert given[0][0] == pytest.approx(0.0, abs=1.0)
    qtbot.waitUntil(lambda: not output._wanted.is_set(), timeout=PATIENCE)
    count = len(given)
    time.sleep(2 * PERIOD_MILLISECONDS / 1000)
    assert len(given) == count
    output.close()


def test_without_a_device_or_without_the_package_it_is_one_sentence(tmp_path, qtbot, monkeypatch):
    pytest.importorskip("miniaudio")
    said = []
    output = output_of(tmp_path, ("CUSTOM",), said.append)
    qtbot.waitUntil(lambda: bool(said), timeout=PATIENCE)
    output.close()
    assert "no sound device was found" in said[0]
    said.clear()
    monkeypatch.setitem(sys.modules, "miniaudio", None)
    output = output_of(tmp_path, (), said.append)
    qtbot.waitUntil(lambda: bool(said), timeout=PATIENCE)
    output.close()
    assert "pip install miniaudio" in said[0]
