"""Settings of the user that are kept between sessions: layout, recent files, preferences. Never project data."""

import json
from pathlib import Path

import platformdirs
from PySide6.QtCore import QByteArray, QSettings

from studio.io.json_text import JsonObject

MAX_RECENT_PROJECTS = 10
MAX_IMPORT_CORRECTIONS = 100
LAYOUT_VERSION = 1


class Settings:
    """Settings stored in a file of the user's configuration folder."""

    def __init__(self, file: Path | None = None) -> None:
        folder = Path(platformdirs.user_config_dir("morpho-studio", appauthor=False))
        self._store = QSettings(str(file or folder / "studio.ini"), QSettings.Format.IniFormat)

    @property
    def recent(self) -> tuple[Path, ...]:
        """Paths of recent projects, newest first."""
        stored = self._store.value("recent")
        names = stored if isinstance(stored, list) else [stored] if stored else []
        return tuple(Path(str(name)) for name in names)

    def remember(self, path: Path) -> None:
        """Add a project at the head of the recent ones."""
        path = path.resolve()
        names = [str(path), *(str(other) for other in self.recent if other != path)]
        self._store.setValue("recent", names[:MAX_RECENT_PROJECTS])

    @property
    def folder(self) -> str:
        """Folder of the user's last file dialog."""
        return str(self._store.value("folder", str(Path.home())))

    @folder.setter
    def folder(self, folder: Path) -> None:
        self._store.setValue("folder", str(folder))

    @property
    def source_folders(self) -> tuple[Path, ...]:
        """Folders from which captures were imported, newest first."""
        stored = self._store.value("sources")
        names = stored if isinstance(stored, list) else [stored] if stored else []
        return tuple(Path(str(name)) for name in names)

    def remember_source(self, path: Path) -> None:
        """Add the folder of a capture's file at the head of the folders that are searched for sources."""
        folder = path.resolve().parent
        names = [str(folder), *(str(other) for other in self.source_folders if other != folder)]
        self._store.setValue("sources", names[:MAX_RECENT_PROJECTS])

    @property
    def exported(self) -> JsonObject:
        """Choices of the last export."""
        try:
            stored = json.loads(str(self._store.value("exported", "{}")))
        except ValueError:
            return {}  # a settings file that somebody has edited
        return stored if isinstance(stored, dict) else {}

    @exported.setter
    def exported(self, choices: JsonObject) -> None:
        self._store.setValue("exported", json.dumps(choices))

    @property
    def corrections(self) -> dict[str, JsonObject]:
        """Corrected import options by kind of file."""
        try:
            stored = json.loads(str(self._store.value("corrections", "{}")))
        except ValueError:
            return {}  # a settings file that somebody has edited
        return stored if isinstance(stored, dict) else {}

    def correct(self, kind: str, options: JsonObject) -> None:
        """Store corrected import options for a kind of file; empty ``options`` remove them."""
        kept = {key: value for key, value in self.corrections.items() if key != kind}
        if options:
            kept[kind] = options
        newest = dict(list(kept.items())[-MAX_IMPORT_CORRECTIONS:])
        self._store.setValue("corrections", json.dumps(newest))

    @property
    def preferences(self) -> JsonObject:
        """Preferences by name."""
        try:
            stored = json.loads(str(self._store.value("preferences", "{}")))
        except ValueError:
            return {}  # a settings file that somebody has edited
        return stored if isinstance(stored, dict) else {}

    @preferences.setter
    def preferences(self, values: JsonObject) -> None:
        self._store.setValue("preferences", json.dumps(values))

    def layout(self) -> tuple[QByteArray, QByteArray] | None:
        """Geometry and panel layout of the window; None before the window was closed once."""
        geometry, state = self._store.value("geometry"), self._store.value(f"state {LAYOUT_VERSION}")
        if isinstance(geometry, QByteArray) and isinstance(state, QByteArray):
            return geometry, state
        return None

    def remember_layout(self, geometry: QByteArray, state: QByteArray) -> None:
        """Store geometry and panel layout of the window."""
        self._store.setValue("geometry", geometry)
        self._store.setValue(f"state {LAYOUT_VERSION}", state)
        self._store.sync()  # the process ends at once

    def forget_layout(self) -> None:
        """Remove the stored layout, so that the next window has the default one."""
        self._store.remove("geometry")
        self._store.remove(f"state {LAYOUT_VERSION}")
