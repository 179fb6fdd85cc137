"""Objections: reasons, in sentences, why constraints cannot be combined."""

from collections.abc import Iterable, Sequence
from dataclasses import fields, replace

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import TRUNK_PARTS, BodyPoint, Chain, Constraint, limb_bones
from studio.core.constraints.follow import FollowBody
from studio.core.curves.keyed import KeyedNumber

_LIMBS = tuple(
    tuple(BodyPart(f"{side}_{bone}") for bone in bones)
    for side in ("left", "right")
    for bones in (("upper_arm", "forearm", "hand"), ("thigh", "shank", "foot", "toe"))
)
_FIELDS_OF_EVERY_KIND = {"motion_id", "scope", "name", "chain", "priority", "activation", "enabled", "weight"}
"""Fields that do not describe the target of a constraint."""
_MANY = {"area", "clear"}
"""Kinds of which one point may have several at once."""
_BLENDED = {"position", "orientation"}
"""Kinds whose targets are blended by weight."""


def objection(constraint: Constraint, others: Iterable[Constraint]) -> str | None:
    """Sentence that says why ``constraint`` cannot be combined with ``others`` of its motion; None if it can."""
    if not constraint.enabled:
        return None
    if is_stuck(constraint):
        return (
            f"'{constraint.name}': no free segment of the IK chain moves the {constraint.point.part.label.lower()}."
            " Free more segments, or choose another point."
        )
    if _carries_its_goal(constraint):
        return (
            f"'{constraint.name}' cannot follow a point farther out on its own limb, which moves with it. Follow a"
            " point of another limb."
        )
    rivals = [
        each
        for each in others
        if each.enabled and each.motion_id == constraint.motion_id and each.scope.meets(constraint.scope)
    ]
    for other in rivals:
        if _rivals(constraint, other):
            if _asked(constraint) == _asked(other):
                return (
                    f"'{constraint.name}' duplicates '{other.name}': same settings, time and priority. Delete one of"
                    " them."
                )
            blended = are_blended(constraint, other)
            if constraint.kind not in _MANY and not (blended and _is_keyed(constraint.weight, other.weight)):
                ways = (
                    "another priority, other times or a keyed weight" if blended else "another priority or other times"
                )
                return (
                    f"'{constraint.name}' conflicts with '{other.name}': both constrain the same point at the same time"
                    f" with the same priority. Give one of them {ways}."
                )
    circle = _follow_cycle(constraint, rivals)
    if circle:
        names = ", ".join(f"'{each.name}'" for each in circle)
        return f"'{constraint.name}' would follow itself: {names} form a cycle. Give one of them a fixed target."
    return None


def is_stuck(constraint: Constraint) -> bool:
    """True if no movable part of the chain can move the point, or the other end of a distance."""
    if constraint.kind in ("balance", "clear"):
        return False
    other = getattr(constraint, "other", None)
    ends = (constraint.point, other) if isinstance(other, BodyPoint) else (constraint.point,)
    return not any(_moves(constraint.chain, point.part) for point in ends)


def _moves(chain: Chain, part: BodyPart) -> bool:
    """True if a movable part of the chain moves a part of the body."""
    side, _, bone = part.value.partition("_")
    links, carriers = ["root"], [*TRUNK_PARTS]
    match bone or part:
        case BodyPart.PELVIS | BodyPart.ABDOMEN:
            carriers = [*TRUNK_PARTS[: 1 + TRUNK_PARTS.index(part)]]
        case BodyPart.NECK:
            carriers += [BodyPart.NECK]
        case BodyPart.HEAD:
            carriers += [BodyPart.NECK, BodyPart.HEAD]
        case "thigh" | "shank" | "foot" | "toe":
            links += ["end_segment"]
            carriers = [BodyPart.PELVIS, *limb_bones(part)[: 1 if bone == "thigh" else 2]]
        case "clavicle" | "upper_arm" | "forearm" | "hand":
            links += ["end_segment"] * (bone == "hand")
            carriers += [BodyPart(f"{side}_clavicle"), *limb_bones(part)[: 1 if bone == "upper_arm" else 2]]
    return any(getattr(chain, link) > 0.0 for link in links) or any(chain.weight(each) > 0.0 for each in carriers)


def _carries_its_goal(constraint: Constraint) -> bool:
    """True if a point on a limb follows a point farther out on the same limb."""
    followed, own = _followed(constraint), constraint.point
    if followed is None or constraint.kind != "position":
        return False
    for limb in _LIMBS:
        if own.part in limb and followed.part in limb:
            bone = limb.index(own.part) - (not own.at_end and not any(own.offset))  # a joint ends the bone before it
            return 0 <= bone <= limb.index(followed.part)
    return False


def objections(constraints: Sequence[Constraint]) -> list[str]:
    """Objections to a set of constraints, each pair once."""
    found = (objection(each, constraints[:index]) for index, each in enumerate(constraints))
    return [sentence for sentence in found if sentence]


def _rivals(first: Constraint, second: Constraint) -> bool:
    """True if two constraints of one kind and priority act on one subject and are fully active at the same time."""
    if first.kind != second.kind or first.priority != second.priority or _about(first) != _about(second):
        return False
    a, b = first.activation, second.activation
    begin, end = max(a.full, b.full), min(a.full_end, b.full_end)
    return begin < end or (begin == end and a == b)


def blended_thing(constraint: Constraint) -> object:
    """Kind of constraint and point or segment whose targets of equal priority are blended by weight.

    None for other kinds, and for targets on the own body.
    """
    is_blended = constraint.kind in _BLENDED and _followed(constraint) is None
    return (constraint.kind, _about(constraint)) if is_blended else None


def are_blended(first: Constraint, second: Constraint) -> bool:
    """True if the targets of two constraints are blended by weight when their priorities are equal."""
    thing = blended_thing(first)
    return thing is not None and thing == blended_thing(second)


def _is_keyed(*weights: float | KeyedNumber) -> bool:
    return any(isinstance(weight, KeyedNumber) for weight in weights)


def _about(constraint: Constraint) -> object:
    """Subject of a constraint: the point, segment or other part of the body that it concerns."""
    other = getattr(constraint, "other", None)
    match constraint.kind:
        case "balance":
            return None
        case "orientation":
            return constraint.point.part
        case "distance":
            return constraint.point, other
    return constraint.point


def _asked(constraint: Constraint) -> tuple[object, ...]:
    return tuple(
        getattr(constraint, each.name) for each in fields(constraint) if each.name not in _FIELDS_OF_EVERY_KIND
    )


def _follow_cycle(constraint: Constraint, others: Sequence[Constraint]) -> list[Constraint]:
    """Constraints, beginning with ``constraint``, through which its point follows itself; empty if there is
    no cycle.
    """
    way, found = [constraint], _followed(constraint)
    while found is not None:
        if _same_point(found, constraint):
            return way
        following = [
            each
            for each in others
            if each not in way
            and each.kind == constraint.kind
            and _overlap(each, constraint)
            and _same_point(found, each)
            and _followed(each) is not None
        ]
        if not following:
            return []
        way.append(following[0])
        found = _followed(following[0])
    return []


def _followed(constraint: Constraint) -> BodyPoint | None:
    """Point of the same body that the constraint's point follows."""
    target = getattr(constraint, "target", None)
    moves = constraint.kind in ("position", "orientation")
    return target.point if moves and isinstance(target, FollowBody) else None


def _same_point(point: BodyPoint, constraint: Constraint) -> bool:
    own = constraint.point
    if constraint.kind == "orientation":
        return own.part == point.part
    return replace(own, offset=(0.0, 0.0, 0.0)) == replace(point, offset=(0.0, 0.0, 0.0))


def _overlap(first: Constraint, second: Constraint) -> bool:
    a, b = first.activation, second.activation
    return max(a.start, b.start) < min(a.end, b.end)
