"""Read, adapt to its own body, write, read: every format gives every joint of real captures back within 0.1 mm."""

import pytest

from benchmarks.format_tables import SUFFIXES, lost_millimetres
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import take_of_actor
from studio.io.importing import load_capture
from studio.jobs.adaptation import ready_from_capture
from tests.captures import outside
from tests.real.taken import named

CLIPS = ("accad_male2_G7_Capoeira", "pybvh_test3_fingers", "mass_backflip", "bvhtoolbox_walk01")


@pytest.fixture(scope="module", params=["dance", "get_up", *outside(*CLIPS)])
def take(request):
    ready = ready_from_capture(load_capture(named(request.param)))
    asked = AdaptRequest(ready.motion, ready.actor.morphology, ready.contacts)
    return take_of_actor(adapt(asked, ready.capture.first_frame), ready.actor, ready.capture, asked)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_nothing_of_a_tenth_of_a_millimetre_is_lost(take, tmp_path, suffix):
    if suffix == ".usd":
        pytest.importorskip("pxr", reason="usd-core is not installed")
    assert lost_millimetres(take, tmp_path / f"out{suffix}") < 0.1
