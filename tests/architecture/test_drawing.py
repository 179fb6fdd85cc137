"""The drawing of the packages in docs/architecture.md is the one that is made from the import contracts."""

from examples.make_architecture import BEGIN, END, PAGE, drawing


def test_the_drawing_of_the_packages_is_made_from_the_import_contracts():
    drawn = PAGE.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0]
    assert drawn == drawing(), "python examples/make_architecture.py draws it anew"
