"""``formats``: list the known file formats, what can be done with each, and those that failed to load."""

from argparse import Namespace

from studio.cli.printing import print_json, print_table
from studio.io.registry import known_formats


def run(arguments: Namespace) -> int:
    """List the formats; returns 1 if one of an installed package could not be added."""
    known = known_formats()
    if arguments.json:
        records = [
            {"name": each.name, "suffixes": list(each.suffixes), "reads": each.reads, "writes": each.writes}
            for each in known.formats
        ]
        print_json({"formats": records, "failures": list(known.failures)})
    else:
        rows = [
            [each.name, " ".join(each.suffixes), ", ".join(each.reads) or "-", ", ".join(each.writes) or "-"]
            for each in known.formats
        ]
        print_table(("format", "suffixes", "reads", "writes"), rows)
        for sentence in known.failures:
            print(f"\n{sentence}")
    return 1 if known.failures else 0
