from tests.architecture.sources import ROOT

MOST_AT_THE_TOP = 25


def test_a_format_lies_in_a_folder_of_its_own():
    assert len(list((ROOT / "studio" / "io").glob("*.py"))) <= MOST_AT_THE_TOP
