"""Jobs of a batch on a running Dask cluster."""

from collections.abc import Iterator, Sequence

from studio.cli.batch_jobs import BatchJob, Record, died, work
from studio.core.errors import StudioError

_PATIENCE = 10.0
"""Seconds to wait for a scheduler to answer."""


def run_there(jobs: Sequence[BatchJob], scheduler: str) -> Iterator[Record]:
    """Record of each job as soon as the workers of the ``scheduler`` at that address have done it.

    The job of a worker that dies is given to another one.
    """
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise StudioError(
            "A Dask cluster needs the package 'distributed'. Install it with `pip install morpho-studio[batch]`."
        ) from error
    try:
        client = Client(scheduler, timeout=_PATIENCE)
    except (OSError, ValueError, ImportError) as error:
        raise StudioError(f"No scheduler answers at '{scheduler}'. Start one with `dask scheduler`.") from error
    with client:
        futures = {client.submit(work, job, key=f"adapt-{job.name}-{job.digest[:12]}", pure=False): job for job in jobs}
        for future in as_completed(futures):
            job = futures[future]
            yield future.result() if future.status == "finished" else died(job)
            future.release()
