"""The tables in the documents are what was measured: nobody writes them by hand."""

import json
from pathlib import Path

import pytest

from benchmarks.report import HEADER, PARTS, replaced, tables

DOCS = Path(__file__).resolve().parents[2] / "docs"


@pytest.fixture(scope="module")
def record():
    return json.loads((DOCS / "benchmark.json").read_text(encoding="utf-8"))


def test_the_page_of_the_benchmark_is_what_was_measured(record):
    assert (DOCS / "benchmark.md").read_text(encoding="utf-8") == HEADER + tables(record)


@pytest.mark.parametrize("name", PARTS)
def test_the_evidence_shows_what_was_measured(record, name):
    text = (DOCS / "evidence.md").read_text(encoding="utf-8")
    assert f"<!-- measured: {name} -->" in text
    assert replaced(text, name, PARTS[name](record)) == text


def test_only_what_stands_between_the_marks_is_replaced():
    text = "a\n<!-- measured: x -->\nold\n<!-- end of what was measured -->\nb\n"
    once = replaced(text, "x", "new\n")
    assert once == "a\n<!-- measured: x -->\nnew\n<!-- end of what was measured -->\nb\n"
    assert replaced(once, "x", "new\n") == once
    assert replaced(text, "y", "new\n") == text
