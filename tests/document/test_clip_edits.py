"""Edits of clips, and what goes with them."""

from studio.core.body.canonical import BodyPart
from studio.core.stage.correction import PoseOffsets, new_correction
from studio.document.clip_edits import duplicate_clip, mirror_clip
from studio.document.document import Document
from tests.builders import make_project


def test_a_mirrored_clip_takes_the_corrections_of_its_time_to_the_other_side():
    """One that lasts into the next clip would be wrong in either, and stays."""
    document = Document(make_project(characters=1, constraints=0, contacts=0, frames=121))
    ((performer_id, performer),) = document.project.performers.items()
    (clip,) = performer.clips
    duplicate_clip(document, clip.id)
    end = document.project.performers[performer_id].clips[1].start
    turn = PoseOffsets(((BodyPart.LEFT_FOREARM, (0.4, 0.1, 0.2)),), (0.0, 0.05, 0.0))
    within, across = (
        document.add("corrections", new_correction("Left elbow", performer_id, time, turn), "")
        for time in (end / 2, end)
    )
    before = document.project
    mirror_clip(document, clip.id)
    mirrored = document.project.corrections[within]
    assert (mirrored.name, mirrored.keys.parts) == ("Right elbow", (BodyPart.RIGHT_FOREARM,))
    assert mirrored == before.corrections[within].mirrored()
    assert document.project.corrections[across] is before.corrections[across]
    document.undo_stack.undo()
    assert document.project.corrections == before.corrections
    assert document.project.performers == before.performers
    document.close()
