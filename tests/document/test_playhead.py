"""The playhead follows the clock, skips late frames, and leaves no timer behind."""

from typing import Any

from PySide6.QtCore import QTimer

from studio.document.playhead import Playhead


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def make_playhead() -> tuple[Playhead, Clock]:
    clock = Clock()
    playhead = Playhead(clock=clock)
    playhead.frame_rate = 10.0
    playhead.set_range(0, 19)
    return playhead, clock


def tick(playhead: Playhead, clock: Clock, seconds: float) -> None:
    clock.now += seconds
    for timer in playhead.findChildren(QTimer):
        timer.timeout.emit()


def test_playback_is_where_the_clock_says_however_late_the_tick(qapp: Any) -> None:
    playhead, clock = make_playhead()
    playhead.play()
    for seconds in (0.01, 0.2, 0.9):
        tick(playhead, clock, seconds)
    assert playhead.frame == 11
    playhead.pause()


def test_a_loop_shows_the_last_frame_and_begins_again(qapp: Any) -> None:
    playhead, clock = make_playhead()
    playhead.play()
    tick(playhead, clock, 1.95)
    assert playhead.frame == 19
    tick(playhead, clock, 0.15)
    assert playhead.frame == 1
    playhead.pause()


def test_without_a_loop_it_stops_at_the_end_and_plays_again_from_the_start(qapp: Any) -> None:
    playhead, clock = make_playhead()
    playhead.loop = False
    playhead.play()
    tick(playhead, clock, 7.0)
    assert (playhead.frame, playhead.playing) == (19, False)
    playhead.play()
    assert playhead.frame == 0
    playhead.pause()


def test_half_speed_and_backwards(qapp: Any) -> None:
    playhead, clock = make_playhead()
    playhead.set_frame(10)
    playhead.speed = 0.5
    playhead.play()
    tick(playhead, clock, 1.0)
    assert playhead.frame == 15
    playhead.speed = -1.0
    tick(playhead, clock, 1.0)
    assert playhead.frame == 5
    playhead.pause()


def test_no_timer_lives_while_paused(qapp: Any, qtbot: Any) -> None:
    playhead, _ = make_playhead()
    playhead.play()
    playhead.pause()
    qtbot.waitUntil(lambda: not playhead.findChildren(QTimer))


def test_stepping_pauses_and_stays_in_the_range(qapp: Any) -> None:
    playhead, _ = make_playhead()
    playhead.set_frame(18)
    playhead.play()
    playhead.step(1)
    playhead.step(1)
    assert (playhead.frame, playhead.playing) == (19, False)
    playhead.step(-40)
    assert playhead.frame == 0
