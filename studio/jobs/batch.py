"""Batch: every capture of a folder is adapted by many processes; unchanged results are skipped."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from studio.core.errors import StudioError
from studio.core.names import counted_noun
from studio.io.json_text import JsonObject
from studio.jobs.adaptation import make_folder
from studio.jobs.adapted_files import AdaptSettings
from studio.jobs.batch_cluster import run_in_cluster
from studio.jobs.batch_jobs import REPORTS_FOLDER, BatchJob, find_jobs, finished_record
from studio.jobs.batch_summary import SUMMARY_PAGE_FILE, SUMMARY_TABLE_FILE, write_summary
from studio.jobs.batch_workers import run_in_workers


@dataclass(frozen=True)
class BatchSettings:
    """Settings of a batch: its folders, the adaptation, and where its jobs run."""

    source: Path
    """Folder of captures; its subfolders are included."""
    out: Path
    """Folder for the adapted files."""
    adapt: AdaptSettings
    overwrite: bool = False
    """True to write into a folder that holds other files."""
    workers: int | None = None
    """Number of processes; None for the number of processor cores."""
    scheduler: str | None = None
    """Address of a running Dask cluster to use instead of processes of this machine."""


@dataclass(frozen=True)
class FileDone:
    """Progress report: one more file of a batch is done."""

    number: int
    """Number of files done, this one included."""
    count: int
    name: str
    outcome: str
    """Outcome: ``unchanged``, ``done``, or the error message."""


@dataclass(frozen=True)
class BatchResult:
    """Result of a batch: records of all files, in the order of their names."""

    out: Path
    records: tuple[JsonObject, ...]
    unchanged: int

    @property
    def failed(self) -> int:
        """Number of files that could not be adapted."""
        return sum("error" in record for record in self.records)

    @property
    def adapted(self) -> int:
        """Number of files that were adapted in this run."""
        return len(self.records) - self.unchanged - self.failed

    @property
    def summary(self) -> str:
        """Summary as a sentence."""
        return (
            f"{counted_noun(len(self.records), 'file')}: {self.adapted} adapted, {self.unchanged} unchanged,"
            f" {self.failed} failed."
        )

    @property
    def table(self) -> Path:
        """Path of the summary as a table for other programs."""
        return self.out / SUMMARY_TABLE_FILE

    @property
    def page(self) -> Path:
        """Path of the summary as a page with plots."""
        return self.out / SUMMARY_PAGE_FILE


def run_batch(
    settings: BatchSettings, told: Callable[[FileDone], object], waited: Callable[[], object] = lambda: None
) -> BatchResult:
    """Adapt captures without a current result, write the summary, and return the result.

    ``told`` is called for each file, ``waited`` a few times per second. If one of them raises an exception, the workers
    end, and the summary has the finished files; a later run continues from there. Raises StudioError for unusable
    folders and characters; an error in one file becomes its record.
    """
    settings.adapt.cast()  # what is missing is told before any work
    jobs = find_jobs(settings.source, settings.out, settings.adapt)
    _refuse_others_folder(settings)
    make_folder(settings.out / REPORTS_FOLDER)
    records = {job.name: record for job in jobs if (record := finished_record(job)) is not None}
    unchanged = len(records)
    try:
        for number, name in enumerate(records, 1):
            told(FileDone(number, len(jobs), name, "unchanged"))
        waiting = [job for job in jobs if job.name not in records]
        with closing(_run(waiting, settings, waited)) as done:
            for record in done:
                records[record["name"]] = record
                told(FileDone(len(records), len(jobs), record["name"], record.get("error") or "done"))
    finally:
        ordered = tuple(records[job.name] for job in jobs if job.name in records)
        write_summary(settings.out, ordered)
    return BatchResult(settings.out, ordered, unchanged)


def _run(
    jobs: Sequence[BatchJob], settings: BatchSettings, waited: Callable[[], object]
) -> Generator[JsonObject, None, None]:
    if not jobs:
        return
    if settings.scheduler is None:
        yield from run_in_workers(jobs, settings.workers, waited)
    else:
        yield from run_in_cluster(jobs, settings.scheduler, waited)


def _refuse_others_folder(settings: BatchSettings) -> None:
    """Raise StudioError if the folder holds files that no batch has written, since one might be replaced."""
    out = settings.out
    if out.is_dir() and any(out.iterdir()) and not (out / REPORTS_FOLDER).is_dir() and not settings.overwrite:
        raise StudioError(
            f"'{out}' holds files that no batch has written. Choose another folder, or have those of its names replaced"
            " with --overwrite."
        )
