"""Target of a reaction or condition (the partner, a given performer or a prop), and the distance to it."""

from dataclasses import dataclass
from typing import ClassVar

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowPerformer, FollowProp

PELVIS_POINT = BodyPoint(BodyPart.PELVIS)


@dataclass(frozen=True)
class FollowPartner:
    """Target: ``point`` on the body of the partner of the performer that plays the behaviour."""

    kind: ClassVar[str] = "follow_partner"
    point: BodyPoint = PELVIS_POINT


BehaviourTarget = FollowPartner | FollowPerformer | FollowProp


def resolved_target(whom: BehaviourTarget, partner_id: str) -> FollowPerformer | FollowProp | None:
    """Target ``whom`` with the partner filled in; None if it is the partner and ``partner_id`` is empty."""
    if not isinstance(whom, FollowPartner):
        return whom
    return FollowPerformer(partner_id, whom.point) if partner_id else None


def reference_of(whom: BehaviourTarget) -> tuple[tuple[str, str], ...]:
    """(collection, id) of the performer or prop that the target names; empty for the partner."""
    match whom:
        case FollowPerformer():
            return (("performers", whom.performer_id),)
        case FollowProp():
            return (("props", whom.prop_id),)
    return ()


@dataclass(frozen=True)
class DistanceMeasure:
    """Distance from ``point`` of the performer to a point of the target ``whom``; only its horizontal part if ``flat``.

    It is in metres or, if ``legs``, in leg lengths (mean of both bodies), so that one behaviour fits bodies of any
    size.
    """

    whom: BehaviourTarget = FollowPartner()
    point: BodyPoint = PELVIS_POINT
    flat: bool = True
    legs: bool = False

    @property
    def unit(self) -> str:
        """Unit of the distance: ``legs`` or ``m``."""
        return "legs" if self.legs else "m"
