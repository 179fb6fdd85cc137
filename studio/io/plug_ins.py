"""Plug-ins of installed packages, found by entry points: kinds of files and of constraints, measures, verbs, panels.

A package names what it adds in its ``pyproject.toml``, for example a verb:

    [project.entry-points."morpho_studio.verbs"]
    count = "my_package:COUNT"

What cannot be loaded is told with its package and error, and the studio starts without it.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from importlib.metadata import EntryPoint, EntryPoints
from typing import Any, Generic, TypeVar

from studio.core.constraints.base import Constraint, KindInfo
from studio.core.constraints.kinds import ConstraintKind, add_kind
from studio.core.errors import StudioError
from studio.core.quality.motion_measures import MotionMeasure, add_measure

FORMATS_GROUP, VERBS_GROUP, PANELS_GROUP = "morpho_studio.formats", "morpho_studio.verbs", "morpho_studio.panels"
CONSTRAINTS_GROUP, MEASURES_GROUP = "morpho_studio.constraints", "morpho_studio.measures"

T = TypeVar("T")


@dataclass(frozen=True)
class Verb:
    """Verb of the command line, added by a plug-in: ``morpho-studio NAME``, with the name of its entry point."""

    summary: str
    """Line for ``--help``."""
    add_arguments: Callable[[ArgumentParser], object]
    run: Callable[[Namespace], int]
    """Function that does the work and returns the exit code; it raises StudioError."""


@dataclass(frozen=True)
class Panel:
    """Panel of the window, added by a plug-in to the menu *View*."""

    title: str
    make: Callable[[Any], Any]
    """``(scene: studio.api.Scene) -> QWidget``: makes the panel for the open project; its changes are undo steps."""


@dataclass(frozen=True)
class PlugInEntry:
    """Entry point of a plug-in that is not loaded yet."""

    entry: EntryPoint
    words: str
    """Kind of plug-in, such as ``verb``."""

    @property
    def name(self) -> str:
        """Name that the package gives the entry point."""
        return self.entry.name

    @property
    def package(self) -> str:
        """Name of the package that has the entry point."""
        return self.entry.dist.name if self.entry.dist else self.entry.value

    def load(self, accepted: Callable[[Any], T]) -> T:
        """Load the object and return the result of ``accepted``. Raises StudioError for any error of the package."""
        try:
            return accepted(self.entry.load())
        except Exception as error:  # another's code may raise anything
            raise StudioError(
                f"The {self.words} '{self.name}' of {self.package} could not be added: {error or type(error)}"
            ) from error


@dataclass(frozen=True)
class LoadedPlugIns(Generic[T]):
    """Loaded plug-ins of a group, and one error message for each that failed."""

    found: tuple[T, ...]
    failures: tuple[str, ...]


@cache
def entry_points(group: str) -> EntryPoints:
    """Entry points of a group, found only once because the search reads a file of every installed package."""
    return metadata.entry_points(group=group)


def plug_in_entries(group: str) -> Iterator[PlugInEntry]:
    """Entry points of a group; nothing of their packages is imported."""
    words = group.rpartition(".")[2].removesuffix("s")
    return (PlugInEntry(entry, words) for entry in entry_points(group=group))


def load_all(group: str, accepted: Callable[[Any], T]) -> LoadedPlugIns[T]:
    """Plug-ins of a group, loaded and checked by ``accepted``; errors are returned, never raised."""
    found: list[T] = []
    failures: list[str] = []
    for offer in plug_in_entries(group):
        try:
            found.append(offer.load(accepted))
        except StudioError as error:
            failures.append(str(error))
    return LoadedPlugIns(tuple(found), tuple(failures))


def verb_of(value: Any) -> Verb:
    """``value`` if it is a verb. Raises StudioError if it is not."""
    if not isinstance(value, Verb):
        raise StudioError(f"{value!r:.60} is not a studio.api.Verb.")
    return value


def panel_of(value: Any) -> Panel:
    """``value`` if it is a panel. Raises StudioError if it is not."""
    if not isinstance(value, Panel):
        raise StudioError(f"{value!r:.60} is not a studio.api.Panel.")
    return value


def kind_of(value: Any) -> ConstraintKind:
    """``value``, after it is registered as a kind of constraint. Raises StudioError or ValueError if it is none."""
    if not isinstance(value, ConstraintKind):
        raise StudioError(f"{value!r:.60} is not a studio.api.ConstraintKind.")
    kind = value.value
    if not (isinstance(kind, type) and issubclass(kind, Constraint)):
        raise StudioError(f"{kind!r:.60} is not a class of studio.api.Constraint.")
    if not (isinstance(getattr(kind, "kind", None), str) and isinstance(getattr(kind, "shown", None), KindInfo)):
        raise StudioError(f"{kind.__name__} needs 'kind', a name, and 'shown', a studio.api.KindInfo.")
    if kind.unit not in ("m", "rad"):
        raise StudioError(f"{kind.__name__} has the unit '{kind.unit}': its residual is in 'm' or 'rad'.")
    return add_kind(value)


def measure_of_plug_in(value: Any) -> MotionMeasure:
    """``value``, after it is registered as a measure. Raises StudioError or ValueError if it is none."""
    if not isinstance(value, MotionMeasure):
        raise StudioError(f"{value!r:.60} is not a studio.api.MotionMeasure.")
    return add_measure(value)


@cache
def load_registered() -> tuple[str, ...]:
    """Register the kinds of constraint and the measures of all packages, once; return an error message for each that
    failed.
    """
    kinds, measures = load_all(CONSTRAINTS_GROUP, kind_of), load_all(MEASURES_GROUP, measure_of_plug_in)
    return kinds.failures + measures.failures
