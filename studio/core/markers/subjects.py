"""Subjects of a trial by the labels of its points: ``Ann_LASI`` and ``Ben_LASI`` are one marker of two people."""

import re
from collections.abc import Iterable, Sequence

_SPLIT = re.compile(r"[_.\- ]+")
_FEWEST = 4
"""Pairs of left and right that the labels of a subject hold at least."""


def with_subjects(labels: Sequence[str]) -> tuple[str, ...]:
    """The labels with each subject before a colon, ``Ann:LASI``, whatever sign the file puts between; else unchanged.

    Two beginnings name subjects when what follows them is largely the same and has sides of its own: ``L.Knee`` and
    ``R.Knee`` are sides of one body.
    """
    if any(":" in label for label in labels):
        return tuple(labels)
    subjects = _subjects(labels)
    owners = {label: (name, subjects[name][label]) for name in sorted(subjects, key=len) for label in subjects[name]}
    return tuple(":".join(owners[label]) if label in owners else label for label in labels)


def shared_beginning(labels: Sequence[str]) -> str:
    """The beginning with its sign, ``Skeleton_``, that nine tenths of the labels share; empty where they share none."""
    found = _by_beginning(labels)
    beginning = max(found, key=lambda each: len(found[each]), default="")
    own = found.get(beginning, {})
    if len(own) < 0.9 * len(labels) or _pairs(own.values()) < _FEWEST:
        return ""
    return next(label[: len(label) - len(rest)] for label, rest in own.items())


def _subjects(labels: Sequence[str]) -> dict[str, dict[str, str]]:
    """What follows each subject in its labels: beginnings that are followed alike by markers of both sides."""
    found = {name: own for name, own in _by_beginning(labels).items() if _pairs(own.values()) >= _FEWEST}
    alike: dict[str, dict[str, str]] = {}
    for name, own in found.items():
        others = [set(rests.values()) for other, rests in found.items() if other != name]
        if any(2 * len(other.intersection(own.values())) > min(len(own), len(other)) for other in others):
            alike[name] = own
    return alike


def _by_beginning(labels: Sequence[str]) -> dict[str, dict[str, str]]:
    """By everything that stands before a sign in a label: what follows, by label."""
    found: dict[str, dict[str, str]] = {}
    for label in labels:
        for sign in _SPLIT.finditer(label):
            name, rest = label[: sign.start()], label[sign.end() :]
            if name and rest:
                found.setdefault(name, {})[label] = rest
    return found


def _pairs(rests: Iterable[str]) -> int:
    """Count of the labels with a left side at either end that have a fellow on the right."""
    there = {rest.lower() for rest in rests}
    return sum(
        f"{right}{rest.removeprefix(left)}" in there or f"{rest.removesuffix(left)}{right}" in there
        for rest in there
        for left, right in (("left", "right"), ("l", "r"))
        if rest != left and (rest.startswith(left) or rest.endswith(left))
    )
