"""One performer who cannot be adapted does not keep the others from playing."""

from dataclasses import replace

from studio.core.stage.clip import Clip
from studio.core.stage.project import Performer
from studio.document.document import Document
from studio.engine.live_adaptation import LiveAdaptation
from tests.builders import make_capture, make_project
from tests.patience import SECONDS


def test_who_cannot_be_adapted_says_why_and_the_others_play(qapp):
    project = make_project(characters=2)
    project = project.with_entity("captures", "bare", make_capture("bare", body_map=None))
    project = project.with_entity("motions", "bare", replace(project.motions["motion"], capture_id="bare"))
    first = project.performers["performer 0"]
    bare = Performer("Lost", first.character_id, (Clip("bare", 0, 10, id="bare clip"),))
    document = Document(project.with_entity("performers", "lost", bare))
    said = []
    document.problem_reported.connect(said.append)
    live = LiveAdaptation(document)
    assert live.wait_until_solved(SECONDS)
    assert live.result("performer 0") is not None
    assert live.failure("performer 0") == ""
    assert live.failure("lost") == said[-1]
    assert live.result("lost") is None
    document.replace("performers", "lost", replace(bare, clips=first.clips), "")
    assert live.wait_until_solved(SECONDS)
    assert live.failure("lost") == ""
    assert live.result("lost") is not None
    live.close()
    document.close()
