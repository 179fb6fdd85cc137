from tests.architecture.sources import ROOT, functions_of, place_of, product_files

LONGEST_FILE = 500
LONGEST_FUNCTION = 80
LONGEST_MAIN = 20


def line_count(file):
    return len(file.read_text(encoding="utf-8").splitlines())


def test_no_file_is_too_long_to_read_in_one_go():
    too_long = [place_of(file) for file in product_files() if line_count(file) > LONGEST_FILE]
    assert too_long == []


def test_no_function_is_too_long_to_see_at_once():
    too_long = [
        f"{place_of(file, function.lineno)} {function.name}"
        for file in product_files()
        for function in functions_of(file)
        if function.end_lineno - function.lineno + 1 > LONGEST_FUNCTION
    ]
    assert too_long == []


def test_main_only_hands_over():
    assert line_count(ROOT / "main.py") <= LONGEST_MAIN
