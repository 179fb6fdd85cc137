"""Target of a behaviour (the partner of its performer, a given performer or a prop) and the distance to it."""

from dataclasses import dataclass
from typing import ClassVar

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowPerformer, FollowProp

PELVIS_POINT = BodyPoint(BodyPart.PELVIS)


@dataclass(frozen=True)
class FollowPartner:
    """``point`` of the partner of the performer that plays the behaviour."""

    kind: ClassVar[str] = "follow_partner"
    point: BodyPoint = PELVIS_POINT


BehaviourTarget = FollowPartner | FollowPerformer | FollowProp


def followed_by(whom: BehaviourTarget, partner_id: str) -> FollowPerformer | FollowProp | None:
    """Target with the partner filled in; None if the target is the partner and there is none (an empty id)."""
    if not isinstance(whom, FollowPartner):
        return whom
    return FollowPerformer(partner_id, whom.point) if partner_id else None


def reference_of(whom: BehaviourTarget) -> tuple[tuple[str, str], ...]:
    """(collection, id) of the given performer or prop; empty for the partner."""
    match whom:
        case FollowPerformer():
            return (("performers", whom.performer_id),)
        case FollowProp():
            return (("props", whom.prop_id),)
    return ()


@dataclass(frozen=True)
class DistanceMeasure:
    """Distance from ``point`` of the behaviour's performer to a point of ``whom``; horizontal only if ``flat``.

    In metres, or in ``legs``: leg lengths, the mean of both, so that one behaviour fits bodies of any size.
    """

    whom: BehaviourTarget = FollowPartner()
    point: BodyPoint = PELVIS_POINT
    flat: bool = True
    legs: bool = False

    @property
    def unit(self) -> str:
        """Unit of the distance: ``legs`` or ``m``."""
        return "legs" if self.legs else "m"
