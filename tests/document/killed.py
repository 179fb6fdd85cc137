"""Run as a program: forks a child that works on a document, kills it with -9, and looks at what is left.

``python -m tests.document.killed edit|save FOLDER KILLS SEED`` prints the number of kills that it survived.
"""

import os
import select
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from random import Random

from PySide6.QtCore import QCoreApplication

from studio.core.stage.project import Project
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.document.recovery import recover, recoverable_sessions
from studio.io.project.entity_json import project_json
from studio.io.project.project_file import read_project, write_project
from tests.builders import make_project
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
        recovered = recover(session)
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


if __name__ == "__main__":
    check = {"edit": check_edits, "save": check_saves}[sys.argv[1]]
    print(check(Path(sys.argv[2]), int(sys.argv[3]), Random(int(sys.argv[4]))))
