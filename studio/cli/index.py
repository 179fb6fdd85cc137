"""``index``: index folders of captures into the motion library."""

from argparse import Namespace

from studio.cli.printing import print_json, print_table
from studio.core.names import counted_noun
from studio.library.catalogue import Catalogue
from studio.library.indexing import index_folders, load_library
from studio.library.library import LibraryClip
from studio.resources_folder import bundled_strikes_folder
from studio.startup.progress import progress_line


def run(arguments: Namespace) -> int:
    """Index, then list the content of the library; returns 1 if a file or folder could not be used."""
    with Catalogue(arguments.library) as catalogue:
        folders = [*arguments.folders, *([bundled_strikes_folder()] if arguments.bundled else [])]
        report = index_folders(catalogue, folders, progress_line())
        library = load_library(catalogue, progress_line())
        problems = {"catalogue": catalogue.remarks} if catalogue.remarks else {}
    problems |= report.problems
    if arguments.json:
        numbers = {"read": report.read, "kept": report.kept, "forgotten": report.forgotten}
        actors = [{"name": each.name, "stature": round(each.body.stature, 3)} for each in library.actors]
        clips = [clip_record(clip) for clip in library.clips]
        print_json({"ok": not report.problems, **numbers, "actors": actors, "clips": clips, "problems": problems})
    else:
        rows = [
            [str(value) for value in clip_record(clip).values() if not isinstance(value, list)]
            for clip in library.clips
        ]
        print_table(("clip", "take", "limb", "kind", "segment", "first", "last", "hit", "confirmed"), rows)
        found = f"{counted_noun(len(library.clips), 'clip')} of {counted_noun(len(library.actors), 'actor')}"
        print(f"\n{found}; {counted_noun(report.read, 'file')} indexed now.")
        for name, problem in problems.items():
            print(f"{name}: {problem}")
    return 1 if report.problems else 0


def clip_record(clip: LibraryClip) -> dict[str, object]:
    """Record of a clip for JSON."""
    label = clip.label
    return {
        "clip": clip.number,
        "take": clip.take.motion.name,
        "limb": label.limb.words,
        "kind": str(label.kind),
        "segment": str(label.segment),
        "first": label.first,
        "last": label.last,
        "hit": label.hit,
        "confirmed": label.confirmed,
        "tags": list(label.tags),
        "box": clip.path.box.round(4).tolist(),
    }
