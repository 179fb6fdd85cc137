"""``batch``: adapt every capture of a folder to characters, in many processes; unchanged results are skipped."""

import signal
import sys
import threading
from argparse import Namespace
from collections.abc import Generator, Sequence
from contextlib import closing
from pathlib import Path

from studio.cli import adapt
from studio.cli.batch_cluster import run_there
from studio.cli.batch_jobs import FILES_ASKED_FOR, REPORTS, BatchJob, Record, done_before, find_jobs
from studio.cli.batch_summary import rows_of, write_summary
from studio.cli.batch_workers import run_here
from studio.cli.printing import counted, print_json
from studio.core.errors import Stopped, StudioError
from studio.jobs.adaptation import make_folder
from studio.startup.kernel_warm_up import compile_first

_OWN = ("folder", "out", "overwrite", "json", "scheduler", "workers", "capture")
"""Arguments that no result depends on."""


def run(arguments: Namespace) -> int:
    """Adapt captures without a current result, one line on standard error a file; then write the summary. Returns 1 if
    any file failed.
    """
    adapt.asked_by(arguments)
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    asked = {key: value for key, value in vars(arguments).items() if key not in _OWN}
    jobs = find_jobs(arguments.folder, arguments.out, _absolute(asked))
    _refuse_others_folder(arguments.out, arguments.overwrite)
    make_folder(arguments.out / REPORTS)
    records = {job.name: record for job in jobs if (record := done_before(job)) is not None}
    unchanged = len(records)
    for number, name in enumerate(records, 1):
        _tell(number, len(jobs), name, "unchanged")
    waiting = [job for job in jobs if job.name not in records]
    try:
        if waiting:
            compile_first()
        with closing(_run(waiting, arguments.scheduler, arguments.workers)) as done:
            for record in done:
                records[record["name"]] = record
                _tell(len(records), len(jobs), record["name"], record.get("error") or "done")
    except KeyboardInterrupt:
        sentence = f"Stopped after {len(records)} of {len(jobs)} files; the same command goes on from there."
        raise Stopped(sentence) from None
    finally:
        ordered = [records[job.name] for job in jobs if job.name in records]
        write_summary(arguments.out, ordered)
    return _conclude(arguments, jobs, ordered, unchanged)


def _run(jobs: Sequence[BatchJob], scheduler: str | None, workers: int | None) -> Generator[Record, None, None]:
    if jobs:
        yield from run_here(jobs, workers) if scheduler is None else run_there(jobs, scheduler)


def _refuse_others_folder(out: Path, overwrite: bool) -> None:
    """Raise StudioError if the folder holds files that no batch has written, as one might be replaced."""
    if out.is_dir() and any(out.iterdir()) and not (out / REPORTS).is_dir() and not overwrite:
        raise StudioError(
            f"'{out}' holds files that no batch has written. Choose another folder, or have those of its names replaced"
            " with --overwrite."
        )


def _absolute(asked: dict[str, object]) -> dict[str, object]:
    """The arguments with absolute paths, as a worker may have another working folder."""
    asked["character"] = [str(Path(name).resolve()) if Path(name).is_file() else name for name in asked["character"]]  # type: ignore[attr-defined]
    for key in FILES_ASKED_FOR:
        asked[key] = Path(str(asked[key])).resolve() if asked[key] else None
    return asked


def _tell(number: int, count: int, name: str, words: str) -> None:
    print(f"[{number}/{count}] {name}: {words}", file=sys.stderr, flush=True)


def _conclude(arguments: Namespace, jobs: Sequence[BatchJob], records: Sequence[Record], unchanged: int) -> int:
    failed = [record for record in records if "error" in record]
    if arguments.json:
        print_json(
            {
                "ok": not failed,
                "files": len(jobs),
                "unchanged": unchanged,
                "failed": len(failed),
                "summary": str(arguments.out / "summary.csv"),
                "page": str(arguments.out / "summary.html"),
                "rows": rows_of(records),
            }
        )
    else:
        print(
            f"{counted(len(jobs), 'file')}: {len(jobs) - unchanged - len(failed)} adapted, {unchanged} unchanged",
            end=", ",
        )
        print(f"{len(failed)} failed. Summary: {arguments.out / 'summary.csv'}, {arguments.out / 'summary.html'}")
    return 1 if failed else 0
