"""The warm-up is followed until it is done, and its share is that of the kernels that are there."""

from types import SimpleNamespace

from studio.engine import warm_up


def test_following_the_warm_up_reports_rising_shares_until_it_is_done(monkeypatch):
    shares = iter((0.2, 0.5, 0.9))
    running = iter((True, True, True, False))
    monkeypatch.setattr(warm_up, "ready_share", lambda: next(shares))
    monkeypatch.setattr(warm_up, "LOOKED_AT_EVERY", 0.0)
    monkeypatch.setattr(warm_up.WarmUp, "running", property(lambda _: next(running)))
    told = []
    warm_up.WarmUp.follow(object.__new__(warm_up.WarmUp), lambda share, words: told.append((share, words)))
    assert told == [(0.2, ""), (0.5, ""), (0.9, "")]


def test_the_share_counts_kernels_with_a_signature_once_each(monkeypatch):
    done, waiting = SimpleNamespace(signatures=[()]), SimpleNamespace(signatures=[])
    modules = {
        "studio.core.kernels.one": SimpleNamespace(done=done, waiting=waiting),
        "studio.core.kernels.two": SimpleNamespace(done=done, other=3),
    }
    monkeypatch.setattr(warm_up.sys, "modules", modules)
    share = warm_up.ready_share()
    monkeypatch.undo()
    assert share == 0.5
