"""Results that several callers need of one object are computed once, and kept while the object lives."""

import gc
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import pytest

from studio.core.sharing import Shared


@dataclass(frozen=True)
class Owner:
    """Object that sources refer to."""


@dataclass(frozen=True)
class Source:
    """Told apart by its name from others of its owner; its remark changes no result."""

    owner: Owner
    name: str
    remark: str = ""


def _by_owner(computed: list[str]) -> Shared[Source, list[str]]:
    def compute(source: Source) -> list[str]:
        computed.append(source.name)
        return [source.name]

    return Shared(compute, owner=lambda source: source.owner, terms=lambda source: source.name)


def test_threads_that_ask_while_it_is_computed_share_the_result() -> None:
    begun, go_on, asked = threading.Event(), threading.Event(), []

    def compute(key: Owner) -> list[Owner]:
        asked.append(key)
        begun.set()
        go_on.wait()
        return []

    shared, key = Shared(compute), Owner()
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(shared, key)
        begun.wait()
        second = pool.submit(shared, key)
        while not second.running():
            pass
        threading.Timer(0.05, go_on.set).start()
        assert first.result() is second.result()
    assert shared(key) is first.result()
    assert len(asked) == 1


def test_a_thread_that_waits_for_one_that_is_cancelled_computes_it_itself() -> None:
    begun, go_on = threading.Event(), threading.Event()

    def compute(key: Owner, cancelled: bool) -> str:
        if cancelled:
            begun.set()
            go_on.wait()
            raise InterruptedError
        return "done"

    shared, key = Shared(compute), Owner()
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(shared, key, True)
        begun.wait()
        second = pool.submit(shared, key, False)
        threading.Timer(0.05, go_on.set).start()
        with pytest.raises(InterruptedError):
            first.result()
        assert second.result() == "done"


def test_what_goes_wrong_is_told_every_time() -> None:
    def compute(key: Owner) -> None:
        raise ValueError("wrong")

    shared, key = Shared(compute), Owner()
    for _ in range(2):
        with pytest.raises(ValueError, match="wrong"):
            shared(key)


def test_sources_that_differ_in_what_does_not_matter_share_one_result() -> None:
    computed: list[str] = []
    shared, owner = _by_owner(computed), Owner()
    assert shared(Source(owner, "a")) is shared(Source(owner, "a", "remark"))
    assert computed == ["a"]


def test_sources_of_one_owner_that_differ_have_results_of_their_own() -> None:
    computed: list[str] = []
    shared, owner = _by_owner(computed), Owner()
    assert [shared(Source(owner, name)) for name in "aba"] == [["a"], ["b"], ["a"]]
    assert shared(Source(Owner(), "a")) == ["a"]


def test_a_result_is_freed_with_its_owner() -> None:
    shared, owner = Shared(lambda _source: Owner()), Owner()
    result = weakref.ref(shared(owner))
    assert result() is not None
    del owner
    gc.collect()
    assert result() is None
