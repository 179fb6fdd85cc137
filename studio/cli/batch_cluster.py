"""Where the jobs of a batch run: worker processes of this machine, or a Dask cluster that is already there."""

import logging
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from studio.cli.batch_jobs import Job, Record, failure, work
from studio.core.errors import StudioError

if TYPE_CHECKING:
    from distributed import Client

_PATIENCE = 10.0
"""Seconds to wait for a scheduler to answer."""


@contextmanager
def cluster(scheduler: str | None, workers: int | None) -> "Iterator[Client]":
    """A client of the scheduler at that address, or of worker processes that live as long as the block."""
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise StudioError(
            "Many files at once need the package 'distributed'. Install it with `pip install morpho-studio[batch]`."
        ) from error
    if scheduler is None:
        with (
            LocalCluster(  # everything on loopback, on ports that are free
                n_workers=workers or os.cpu_count() or 1,
                threads_per_worker=1,
                host="127.0.0.1",
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
            ) as local,
            Client(local) as client,
        ):
            yield client
        return
    try:
        client = Client(scheduler, timeout=_PATIENCE)
    except (OSError, ValueError, ImportError) as error:
        raise StudioError(f"No scheduler answers at '{scheduler}'. Start one with `dask scheduler`.") from error
    with client:
        yield client


def run_jobs(client: "Client", jobs: Sequence[Job]) -> Iterator[Record]:
    """The record of each job as it is done. The job of a worker that dies is given to another."""
    from distributed import as_completed

    futures = {client.submit(work, job, key=f"adapt-{job.name}-{job.digest[:12]}", pure=False): job for job in jobs}
    for future in as_completed(futures):
        job = futures[future]
        if future.status == "finished":
            yield future.result()
        else:
            yield failure(job, f"{job.name}: every worker that was given this file died of it. Look at it alone.")
        future.release()
