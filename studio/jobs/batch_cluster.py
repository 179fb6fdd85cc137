"""Jobs of a batch on a running Dask cluster."""

import time
from collections.abc import Callable, Iterator, Sequence

from studio.core.errors import StudioError
from studio.io.json_text import JsonObject
from studio.jobs.batch_jobs import BatchJob, adapt_job, death_record
from studio.startup.process import prepare_process

_PATIENCE = 10.0
"""Seconds to wait for a scheduler to answer."""
CLUSTER_POLL_SECONDS = 0.1
"""Seconds between two checks for finished jobs."""


def run_in_cluster(jobs: Sequence[BatchJob], scheduler: str, waited: Callable[[], object]) -> Iterator[JsonObject]:
    """Records of the jobs as soon as the workers of the scheduler at the address ``scheduler`` have done them.

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
        client.run(prepare_process)
        futures = {
            client.submit(adapt_job, job, key=f"adapt-{job.name}-{job.digest[:12]}", pure=False): job for job in jobs
        }
        ready = as_completed(futures)
        while not ready.is_empty():
            waited()
            done = ready.next_batch(block=False)
            if not done:
                time.sleep(CLUSTER_POLL_SECONDS)
            for future in done:
                yield future.result() if future.status == "finished" else death_record(futures[future])
                future.release()
