"""Subjects of a trial, found in the labels of its points: ``Ann_LASI`` and ``Ben_LASI`` are one marker of
two people.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence

from studio.core.markers.label_words import side_and_part

_SIGN = re.compile(r"[\W_]+")
_FEWEST = 4
"""Pairs of left and right that the labels of a subject hold at least."""
_BODY = 8
"""Places on a body that the labels of a subject say at least, where its name stands in no usual position."""
_ALIKE = 0.8
"""Part of such a subject's labels that another one has too."""
_TOLD = 0.6
"""Places that labels say with names on them, in parts of the labels that say one without, from which those are none."""
_CLUSTERS = ("pelvis", "thigh", "shank", "foot", "upper_arm", "forearm", "hand")
"""Segments whose markers have numbers behind."""
_NAMELESS = "1"
"""Name of a subject whose labels have none, beside others."""
_Splits = Callable[[str], Iterator[tuple[str, str]]]
"""Function that yields possible names of a subject in a label, each with the rest of the label."""
_Owned = dict[str, dict[str, str]]
"""Rests of labels without the subject, by subject and label."""


def with_subjects(labels: Sequence[str]) -> tuple[str, ...]:
    """Labels with the subject first, before a colon (``Ann:LASI``), wherever it stands in the label; else unchanged.

    Two prefixes before a sign name subjects if the rests are largely the same and have sides of their own: ``L.Knee``
    and ``R.Knee`` are sides of one body. Names after a label, or without a sign, are accepted only if a body is
    recognised without them and not with them. A subject without a name beside one with a name is called ``1``.
    """
    named = {label.partition(":")[::2] for label in labels if ":" in label}
    if named and len({name for name, _ in named}) <= len({rest for _, rest in named}):
        return tuple(labels)
    subjects = {} if named else _subjects(_by_name(labels, _before_a_sign))
    for splits in (_behind_a_sign, _at_the_beginning, _at_the_end):
        subjects = subjects or _bodies(labels, _by_name(labels, splits))
    for splits in () if named else (_before_a_sign, _behind_a_sign):
        subjects = subjects or _beside_one_without_name(labels, _by_name(labels, splits))
    owners = {label: (name, subjects[name][label]) for name in sorted(subjects, key=len) for label in subjects[name]}
    return tuple(":".join(owners[label]) if label in owners else label for label in labels)


def shared_beginning(labels: Sequence[str]) -> str:
    """Prefix with its sign, ``Skeleton_``, shared by nine tenths of the labels; empty if there is none."""
    found = _by_name(labels, _before_a_sign)
    beginning = max(found, key=lambda each: len(found[each]), default="")
    own = found.get(beginning, {})
    if len(own) < 0.9 * len(labels) or _pairs(own.values()) < _FEWEST:
        return ""
    return next(label[: len(label) - len(rest)] for label, rest in own.items())


def _subjects(found: _Owned) -> _Owned:
    """Subjects whose labels have the same rests with markers of both sides."""
    found = {name: own for name, own in found.items() if _pairs(own.values()) >= _FEWEST}
    return {name: own for name, own in found.items() if _is_like_another(name, found, 0.5)}


def _bodies(labels: Sequence[str], found: _Owned) -> _Owned:
    """Subjects whose labels name a whole body only after their names are removed."""
    large = {name: own for name, own in found.items() if len(own) >= _BODY and _pairs(own.values()) >= _FEWEST}
    bodies = {name: own for name, own in large.items() if len(_places(own.values())) >= _BODY}
    if len(bodies) > 1:
        bodies = {name: own for name, own in bodies.items() if _is_like_another(name, bodies, _ALIKE)}
    owned = {label for own in bodies.values() for label in own}
    others = _places(label for label in labels if label not in owned)
    telling = {label for own in bodies.values() for label, rest in own.items() if _places([rest])}
    if len(_places(owned)) > _TOLD * len(telling) or len(others) > (1.0 - _ALIKE) * len(owned):
        return {}
    return bodies


def _beside_one_without_name(labels: Sequence[str], found: _Owned) -> _Owned:
    """Subjects whose rests are the labels of another body without a name, and that body: ``LASI`` and ``LASI_2``.

    A model's copy of some markers beside its joint centres is no other body: positions are missing.
    """
    there = set(labels)
    named = {
        name: own
        for name, own in found.items()
        if len(own) >= _BODY
        and len(there.intersection(own.values())) > _ALIKE * len(own)
        and _pairs(own.values()) >= _FEWEST
    }
    theirs = {label for own in named.values() for label in own}
    shared = {rest for own in named.values() for rest in own.values()}
    nameless = [label for label in labels if label not in theirs and (label in shared or _places([label]))]
    most = max(_BODY, _ALIKE * len(_places(nameless)))
    bodies = {name: own for name, own in named.items() if len(_places(own.values())) >= most}
    if not bodies or _NAMELESS in bodies:
        return {}
    return {_NAMELESS: {label: label for label in nameless}, **bodies}


def _places(labels: Iterable[str]) -> set[tuple[str, str]]:
    """Positions named by the labels of a set with one marker each."""
    return {said for label in labels if (said := side_and_part(label)) is not None and said[1] not in _CLUSTERS}


def _is_like_another(name: str, found: _Owned, share: float) -> bool:
    """True if another subject has more than the fraction ``share`` of the rests, relative to the smaller set."""
    own = set(found[name].values())
    others = [set(rests.values()) for other, rests in found.items() if other != name]
    return any(len(own & other) > share * min(len(own), len(other)) for other in others)


def _by_name(labels: Sequence[str], splits: _Splits) -> _Owned:
    """Rest of each label by possible subjects; every part of a label that may be a name counts."""
    found: _Owned = {}
    for label in labels:
        for name, rest in splits(label):
            if name and rest:
                found.setdefault(name, {})[label] = rest
    return found


def _before_a_sign(label: str) -> Iterator[tuple[str, str]]:
    for sign in _SIGN.finditer(label):
        yield label[: sign.start()], label[sign.end() :]


def _behind_a_sign(label: str) -> Iterator[tuple[str, str]]:
    for sign in _SIGN.finditer(label):
        yield label[sign.end() :], label[: sign.start()]


def _at_the_beginning(label: str) -> Iterator[tuple[str, str]]:
    for index in range(1, len(label)):
        yield label[:index], label[index:]


def _at_the_end(label: str) -> Iterator[tuple[str, str]]:
    for index in range(1, len(label)):
        yield label[index:], label[:index]


def _pairs(rests: Iterable[str]) -> int:
    """Number of labels with a left side at either end that have a counterpart on the right."""
    there = {rest.lower() for rest in rests}
    return sum(
        f"{right}{rest.removeprefix(left)}" in there or f"{rest.removesuffix(left)}{right}" in there
        for rest in there
        for left, right in (("left", "right"), ("l", "r"))
        if rest != left and (rest.startswith(left) or rest.endswith(left))
    )
