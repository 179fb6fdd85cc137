"""The script that makes films of captures on characters beside their source."""

import sys
from importlib import import_module

import numpy as np
import pytest

from studio.resources_folder import example_captures_folder
from tests.architecture.sources import ROOT


def test_a_film_shows_the_source_above_each_character(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "examples")
    monkeypatch.delitem(sys.modules, "make_films", raising=False)
    films = import_module("make_films")
    monkeypatch.setattr(films, "COLUMNS", 2)
    first, last = films.pictures(example_captures_folder() / "straight_punch.bvh", ["child"])
    width, height = films.TILE
    assert first.shape == last.shape == (2 * height, width, 4)
    for column in (first, last):
        assert all(np.ptp(column[row : row + height]) > 0 for row in (0, height))
