"""Run as a program: forks a child that works on a document, kills it with -9, and looks at what is left.

``python -m tests.document.killed edit|save|export|record|index FOLDER KILLS SEED`` prints the number of kills that cost
something.
"""

import os
import select
import signal
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from random import Random

from PySide6.QtCore import QCoreApplication

from studio.core.stage.project import Project
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.document.recovery import recoverable_sessions, recovered_session
from studio.io.export import write_capture
from studio.io.project.entity_json import project_json
from studio.io.project.project_file import read_project, write_project
from studio.library.catalogue import Catalogue
from studio.library.indexing import correct_label, index_folders, load_library
from studio.library.library import Library
from studio.live.recording import Recorder, read_recording
from studio.startup.process import prepare_process
from tests.builders import make_capture, make_project
from tests.library.damaged_catalogue import CAPTURES, make_catalogue
from tests.patience import SECONDS

ID = "00112233445566778899aabbccddeeff"


def edit_for_ever(folder: Path, tell: int) -> None:
    """Props by number are added, each third one undone and redone; every acknowledged count is told."""
    application = QCoreApplication([])
    document = Document(make_project(frames=20), journal_folder=folder)
    told = number = 0
    while True:
        document.add("props", Prop(str(number)), "Add prop")
        if number % 3 == 0:
            document.undo_stack.undo()
            document.undo_stack.redo()
        number += 1
        application.processEvents()
        if document.journal is not None and document.journal.acknowledged > told:
            told = document.journal.acknowledged
            os.write(tell, f"{told}\n".encode())


def save_for_ever(path: Path, tell: int) -> None:
    """Two projects by turns."""
    for turn in range(1 << 30):
        write_project(path, (small(), large())[turn % 2], ID)
        os.write(tell, b"1\n")


def export_for_ever(paths: Sequence[Path], tell: int) -> None:
    """Two captures by turns, in the format of each path."""
    captures = make_capture(frames=4), make_capture(frames=200)
    for turn in range(1 << 30):
        write_capture(captures[turn % 2], paths[turn // 2 % len(paths)])
        os.write(tell, b"1\n")


def record_for_ever(path: Path, tell: int) -> None:
    """Datagrams by number; the count of those that are kept is told."""
    recorder = Recorder(path)
    for number in range(1 << 30):
        recorder.record_packet(0.001 * number, str(number).encode() * 20)
        os.write(tell, f"{number + 1}\n".encode())


def index_for_ever(folder: Path, tell: int) -> None:
    """The captures of a folder, read anew each time, and a label that a person corrects between."""
    os.write(tell, b"0\n")
    for number in range(1, 1 << 30):
        with Catalogue(folder / "catalogue") as catalogue:
            for name in CAPTURES:
                os.utime(folder / "takes" / name, (number, number))
            index_folders(catalogue, [folder / "takes"])
            clip = Library.of(catalogue).clips[0]
            correct_label(catalogue, clip.number, replace(clip.label, tags=(f"mine {number}",), confirmed=True))
        os.write(tell, f"{number}\n".encode())


def small() -> Project:
    return make_project(characters=1, frames=4)


def large() -> Project:
    return make_project(characters=3, frames=200)


def killed_child(work: Callable[[int], None], seconds: float) -> int:
    """The last number that the child told before it was killed, ``seconds`` after its first word."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        work(writer)
        os._exit(0)
    os.close(writer)
    select.select([reader], [], [], SECONDS)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    told = b""
    while block := os.read(reader, 65536):
        told += block
    os.close(reader)
    return int(told.split()[-1]) if told.split() else 0


def check_edits(folder: Path, kills: int, chance: Random) -> int:
    lost = 0
    for kill in range(kills):
        own = folder / str(kill)
        acknowledged = killed_child(lambda tell, own=own: edit_for_ever(own, tell), chance.random() * 0.05)
        (session,) = recoverable_sessions(own)
        recovered = recovered_session(session)
        names = [prop.name for prop in recovered.project.props.values()]
        lost += len(recovered.steps) < acknowledged or bool(recovered.problems)
        lost += names != [str(number) for number in range(len(names))]
    return lost


def check_saves(folder: Path, kills: int, chance: Random) -> int:
    path = folder / "walk.studio"
    write_project(path, small(), ID)
    whole = {project_json(small(), {}), project_json(large(), {})}
    lost = 0
    for _ in range(kills):
        killed_child(lambda tell: save_for_ever(path, tell), chance.random() * 0.03)
        opened = read_project(path)
        lost += bool(opened.problems) or project_json(opened.project, {}) not in whole
    return lost


def check_exports(folder: Path, kills: int, chance: Random) -> int:
    paths, lost = [folder / f"walk{suffix}" for suffix in (".bvh", ".fbx", ".glb")], 0
    whole = []
    for path in paths:
        contents = []
        for frames in (4, 200):
            write_capture(make_capture(frames=frames), path)
            contents.append(path.read_bytes())
        whole.append(contents)
    for _ in range(kills):
        killed_child(lambda tell: export_for_ever(paths, tell), chance.random() * 0.1)
        lost += any(path.read_bytes() not in contents for path, contents in zip(paths, whole, strict=True))
    return lost


def check_recordings(folder: Path, kills: int, chance: Random) -> int:
    lost = 0
    for kill in range(kills):
        path = folder / f"{kill}.osc"
        kept = killed_child(lambda tell, path=path: record_for_ever(path, tell), chance.random() * 0.02)
        packets = read_recording(path).packets
        lost += len(packets) < kept
        lost += [packet for _, packet in packets] != [str(number).encode() * 20 for number in range(len(packets))]
    return lost


def check_catalogues(folder: Path, kills: int, chance: Random) -> int:
    made, lost = folder / "made", 0
    make_catalogue(made)
    for _ in range(kills):
        number = killed_child(lambda tell: index_for_ever(made, tell), chance.random() * 2.0)
        with Catalogue(made / "catalogue") as catalogue:
            index_folders(catalogue, [made / "takes"])
            tags = [clip.label.tags for clip in load_library(catalogue).clips if clip.label.confirmed]
            lost += bool(catalogue.remarks) or len(tags) < 1
            if number:
                lost += (f"mine {number}",) not in tags and (f"mine {number + 1}",) not in tags
    return lost


CHECKS = {
    "edit": check_edits,
    "save": check_saves,
    "export": check_exports,
    "record": check_recordings,
    "index": check_catalogues,
}

if __name__ == "__main__":
    prepare_process()
    check = CHECKS[sys.argv[1]]
    print(check(Path(sys.argv[2]), int(sys.argv[3]), Random(int(sys.argv[4]))))
