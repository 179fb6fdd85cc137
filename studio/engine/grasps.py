"""Times at which captured hands hold an object: its position and height."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import Touch
from studio.core.stage.holding import HAND_REACH_SECONDS
from studio.core.stage.project import Project
from studio.core.stage.prop import Carried, Prop
from studio.engine.posed_performer import PosedPerformer, ResultOf, posed_performers, stage_time

FloatArray = NDArray[np.float64]
GRASP_SAMPLES = 16
"""Number of times within a grasp at which the height of the hands is sampled."""


@dataclass(frozen=True)
class Grasp:
    """Time at which a performer's captured hands hold an object: the stage time ``seconds``, and the pose ``holder``
    then.

    ``lowest`` is the minimum height of the middle of the hands above the ground while they hold it, in metres; ``end``
    the stage time in seconds at which they release it.
    """

    seconds: float
    holder: PosedPerformer
    lowest: float
    end: float

    def lift(self, prop: Prop) -> float:
        """Height in metres by which a prop must be above the middle of the hands, so that it stays above the ground."""
        return max(prop.size[2] / 2 - self.lowest, 0.0)


def grasp_near(project: Project, results: ResultOf, performer_id: str, now: float) -> Grasp | None:
    """Grasp of a performer at the stage time ``now``, else the next one, else the last one; None if there is none."""
    spans = captured_grasps(project, performer_id)
    if not spans:
        return None
    first, last = next((span for span in spans if now <= span[1]), spans[-1])
    return _grasp(project, results, performer_id, (first, last), max(first, now) if now <= last else first)


def grasp_at(project: Project, results: ResultOf, performer_id: str, now: float) -> Grasp | None:
    """Grasp of a performer at the stage time ``now``, else the next one; None if there is none."""
    for first, last in captured_grasps(project, performer_id):
        if first - HAND_REACH_SECONDS <= now <= last:
            return _grasp(project, results, performer_id, (first, last), max(first, now))
    return None


def _grasp(
    project: Project, results: ResultOf, performer_id: str, span: tuple[float, float], seconds: float
) -> Grasp | None:
    moments = (seconds, *np.linspace(*span, GRASP_SAMPLES).tolist())
    posed = [posed_performers(project, results, moment).get(performer_id) for moment in moments]
    holders = [each for each in posed if each is not None]
    if len(holders) < len(moments):
        return None
    places = np.array([captured_grasp(each) for each in holders])
    return Grasp(seconds, holders[0], float((places[:, 2] - project.ground.height_at(places)).min()), span[1])


def captured_grasps(project: Project, performer_id: str) -> list[tuple[float, float]]:
    """Ranges of stage time in seconds in which both hands hold an object in the captures of a performer's clips."""
    performer = project.performers.get(performer_id)
    spans = []
    for clip in performer.clips if performer else ():
        rate = project.frame_rate_of(clip)
        for contact in project.contacts_for(performer_id, clip).values():
            first, last = max(contact.first, clip.first), min(contact.last, clip.last)
            if contact.point is Touch.HANDS_ON_THING and first < last:
                begin, end = (stage_time(clip, rate, frame / rate) for frame in (first, last))
                spans.append((begin, end))
    return sorted(spans)


def chest_heading(holder: PosedPerformer) -> float:
    """Heading of the chest on the stage, in radians about Z."""
    from studio.core.solver.performers.prop_tracks import chest_headings  # loads kernels

    thorax = holder.motion.morphology.layout.segment_of_part(BodyPart.THORAX)
    chest = holder.placement.rotation @ holder.motion.rotations[holder.row, thorax]
    return float(chest_headings(chest[None])[0])


def captured_grasp(holder: PosedPerformer) -> FloatArray:
    """(3,) middle of the hands on the stage in the motion before constraints, in metres."""
    from studio.core.solver.performers.prop_tracks import Holder  # loads kernels

    track = Holder(holder.over_time, [holder.frame - holder.over_time.first_frame], holder.placement)
    return np.asarray(track.track(Carried("")).positions[0])
