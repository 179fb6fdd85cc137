"""Fakes of the engine's part offer all that views may ask of it, and take the same arguments."""

import inspect
from contextlib import closing

import pytest

from studio.document.document import Document
from studio.engine.live_adaptation import LiveAdaptation
from studio.engine.live_interface import Live
from tests.builders import make_project
from tests.solved_live import SolvedLive
from tests.timeline.fakes import FakeLive
from tests.viewport.standing import StandingLive

OFFERED = {name: member for name, member in {**Live.__annotations__, **vars(Live)}.items() if not name.startswith("_")}


@pytest.mark.parametrize("kind", [LiveAdaptation, SolvedLive, FakeLive, StandingLive])
def test_the_engine_and_each_fake_of_it_have_every_member_with_the_same_arguments(qapp, kind):
    with closing(Document(make_project())) as document:
        live = kind(document)
        assert [name for name in OFFERED if not hasattr(live, name)] == []
        for name, member in OFFERED.items():
            if inspect.isfunction(member):
                own = inspect.signature(getattr(kind, name))
                assert list(own.parameters) == list(inspect.signature(member).parameters), name
        if kind is LiveAdaptation:
            live.close()
