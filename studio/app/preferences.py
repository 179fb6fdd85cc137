"""Preferences and key maps of the user: their storage, and the shortcuts of each action."""

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields

from PySide6.QtGui import QKeySequence

from studio.app.settings import Settings
from studio.document import colours
from studio.document.length_units import LENGTH_CHOICES
from studio.resources_folder import resources_folder
from studio.viewport.navigation import DEFAULT_NAVIGATION, Navigation
from studio.viewport.onion_skins import OnionSkins
from studio.viewport.snap_steps import SnapSteps

KeyTable = Mapping[str, tuple[str, ...]]
"""Shortcuts by action id."""
STUDIO_KEYS = "studio"
MIN_SNAP_STEP = 1e-3
INTEGER_RANGES = (
    ("onion_before", 0, 20),
    ("onion_after", 0, 20),
    ("onion_step", 1, 120),
    ("autosave_minutes", 0, 600),
    ("interface_scale", 50, 300),
)
FITTED, WHOLE_CLIP_ACTIVATION = "fitted", "whole_clip"
PREFERENCE_CHOICES: Mapping[str, tuple[str, ...]] = {
    "activation": (FITTED, WHOLE_CLIP_ACTIVATION),
    "theme": tuple(colours.THEMES),
    "lengths": tuple(LENGTH_CHOICES),
}


@dataclass(frozen=True)
class Preferences:
    """Preferences of the user. A number outside its range raises ValueError."""

    move_step: float = 1.0
    """Snapping step of the move tool, in centimetres."""
    rotate_step: float = 15.0
    """Snapping step of the rotate tool, in degrees."""
    scale_step: float = 10.0
    """Snapping step of the scale tool, in percent."""
    onion_before: int = 3
    onion_after: int = 3
    onion_step: int = 4
    """Frames between two onion skins."""
    autosave_minutes: int = 0
    """Minutes between two automatic saves of a project that has a file; 0 turns them off."""
    activation: str = FITTED
    """Default activation of a new constraint: fitted to the motion, or the whole clip."""
    theme: str = "dark"
    lengths: str = "usual"
    """Unit of displayed lengths: ``usual`` chooses metres, centimetres or millimetres by field; other values use one
    unit everywhere.
    """
    interface_scale: int = 100
    """Scale of the interface in percent."""
    key_map: str = STUDIO_KEYS
    own_keys: KeyTable = field(default_factory=dict)
    """Shortcuts assigned by the user, which override those of the key map."""

    def __post_init__(self) -> None:
        for each in ("move_step", "rotate_step", "scale_step"):
            value = getattr(self, each)
            if not (isinstance(value, float | int) and math.isfinite(value) and value >= MIN_SNAP_STEP):
                raise ValueError(f"The preference '{each}' must be greater than zero, not {value!r}.")
        for each, least, most in INTEGER_RANGES:
            value = getattr(self, each)
            if not (isinstance(value, int) and least <= value <= most):
                raise ValueError(
                    f"The preference '{each}' must be a whole number from {least} to {most}, not {value!r}."
                )
        for each, allowed in PREFERENCE_CHOICES.items():
            if getattr(self, each) not in allowed:
                raise ValueError(
                    f"The preference '{each}' must be one of {', '.join(allowed)}, not {getattr(self, each)!r}."
                )
        object.__setattr__(self, "own_keys", {key: tuple(keys) for key, keys in dict(self.own_keys).items()})

    @property
    def onion_skins(self) -> OnionSkins:
        """Settings of onion skins for the 3D view."""
        return OnionSkins(self.onion_before, self.onion_after, self.onion_step)

    @property
    def snap_steps(self) -> SnapSteps:
        """Snapping steps of the gizmo, in metres, radians and factors."""
        return SnapSteps(self.move_step / 100.0, math.radians(self.rotate_step), self.scale_step / 100.0)


def load_preferences(settings: Settings) -> Preferences:
    """Stored preferences; invalid values are replaced by defaults."""
    stored = settings.preferences
    kept = {}
    for each in fields(Preferences):
        if each.name in stored:
            try:
                Preferences(**{each.name: stored[each.name]})
            except (TypeError, ValueError):
                continue  # a settings file that somebody has edited
            kept[each.name] = stored[each.name]
    return Preferences(**kept)


def save_preferences(settings: Settings, preferences: Preferences) -> None:
    """Store preferences for the next start."""
    settings.preferences = asdict(preferences)


@dataclass(frozen=True)
class KeyMap:
    """Shortcuts of actions and mouse buttons of the camera that differ from the default ones."""

    name: str
    keys: KeyTable = field(default_factory=dict)
    navigation: Navigation = field(default_factory=lambda: DEFAULT_NAVIGATION)


def key_maps() -> dict[str, KeyMap]:
    """Bundled key maps by id; the default one is empty."""
    maps = {STUDIO_KEYS: KeyMap("Morpho Studio")}
    for file in sorted((resources_folder() / "key_maps").glob("*.json")):
        record = json.loads(file.read_text("utf-8"))
        keys = {key: tuple(keys) for key, keys in record["keys"].items()}
        maps[file.stem] = KeyMap(record["name"], keys, {**DEFAULT_NAVIGATION, **record.get("navigation", {})})
    return maps


def key_map_of(preferences: Preferences) -> KeyMap:
    """Key map chosen in the preferences; the default one if that no longer exists."""
    maps = key_maps()
    return maps.get(preferences.key_map, maps[STUDIO_KEYS])


def keys_with(defaults: KeyTable, *layers: KeyTable) -> dict[str, tuple[str, ...]]:
    """Shortcuts of each action after ``layers`` override ``defaults``: a later layer wins, and a shortcut belongs to
    the last action that it is assigned to.
    """
    keys = {action: tuple(map(_normal, each)) for action, each in defaults.items()}
    for layer in layers:
        own = {action: tuple(map(_normal, each)) for action, each in layer.items() if action in keys}
        taken = {key for each in own.values() for key in each}
        keys = {action: own.get(action, _without(each, taken)) for action, each in keys.items()}
    return keys


def conflicts_in(keys: KeyTable) -> dict[str, tuple[str, ...]]:
    """Shortcuts that are assigned to more than one action, with the ids of these actions."""
    owners: dict[str, list[str]] = {}
    for action, each in keys.items():
        for key in each:
            owners.setdefault(key, []).append(action)
    return {key: tuple(actions) for key, actions in owners.items() if len(actions) > 1}


def keys_in(text: str) -> tuple[str, ...]:
    """Shortcuts in a typed text, separated by spaces. Raises ValueError for an invalid one."""
    words = text.split()
    for word in words:
        if not _normal(word):
            raise ValueError(f"'{word}' is not a shortcut. Write it like Ctrl+Shift+K or F5.")
    return tuple(map(_normal, words))


def _without(keys: Iterable[str], taken: set[str]) -> tuple[str, ...]:
    return tuple(key for key in keys if key not in taken)


def _normal(key: str) -> str:
    return QKeySequence(key).toString()
