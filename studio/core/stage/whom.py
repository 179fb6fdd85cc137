"""Whom a behaviour is about: the partner of who plays it, a certain performer, or a prop; and how far that is."""

from dataclasses import dataclass
from typing import ClassVar

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowPerformer, FollowProp

PELVIS_POINT = BodyPoint(BodyPart.PELVIS)


@dataclass(frozen=True)
class FollowPartner:
    """``point`` of the partner, whoever that is for who plays the behaviour."""

    kind: ClassVar[str] = "follow_partner"
    point: BodyPoint = PELVIS_POINT


Whom = FollowPartner | FollowPerformer | FollowProp


def followed_by(whom: Whom, partner_id: str) -> FollowPerformer | FollowProp | None:
    """What is followed by one with that partner; None where it has no partner (an empty id) and one is meant."""
    if not isinstance(whom, FollowPartner):
        return whom
    return FollowPerformer(partner_id, whom.point) if partner_id else None


def reference_of(whom: Whom) -> tuple[tuple[str, str], ...]:
    """(collection, id) of a certain one that is meant; none for the partner."""
    match whom:
        case FollowPerformer():
            return (("performers", whom.performer_id),)
        case FollowProp():
            return (("props", whom.prop_id),)
    return ()


@dataclass(frozen=True)
class DistanceMeasure:
    """From ``point`` of who plays a behaviour to a point of ``whom``; ``flat`` counts over the ground alone.

    In metres, or in ``legs``: leg lengths, the mean of both, so that one behaviour fits bodies of any size.
    """

    whom: Whom = FollowPartner()
    point: BodyPoint = PELVIS_POINT
    flat: bool = True
    legs: bool = False

    @property
    def unit(self) -> str:
        """What it is counted in."""
        return "legs" if self.legs else "m"
