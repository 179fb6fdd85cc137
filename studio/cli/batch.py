"""``batch``: adapt every capture of a folder to characters, in many processes."""

import signal
import sys
import threading
from argparse import Namespace

from studio.cli.adapt import adapt_settings
from studio.cli.printing import print_json
from studio.core.errors import Stopped
from studio.core.names import counted_noun
from studio.jobs.batch import BatchResult, BatchSettings, FileDone, run_batch
from studio.jobs.batch_summary import summary_rows
from studio.startup.kernel_warm_up import compile_first


def run(arguments: Namespace) -> int:
    """Run the batch, with one line on standard error for each file, and return 1 if any file failed."""
    settings = BatchSettings(
        arguments.folder,
        arguments.out,
        adapt_settings(arguments),
        arguments.overwrite,
        arguments.workers,
        arguments.scheduler,
    )
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    last = FileDone(0, 0, "", "")

    def tell(done: FileDone) -> None:
        nonlocal last
        last = done
        print(f"[{done.number}/{done.count}] {done.name}: {done.outcome}", file=sys.stderr, flush=True)

    try:
        compile_first()
        result = run_batch(settings, tell)
    except KeyboardInterrupt:
        done = f"{last.number} of {counted_noun(last.count, 'file')}" if last.count else "no file"
        raise Stopped(f"Stopped after {done}; run the same command to continue.") from None
    _print_result(result, arguments.json)
    return 1 if result.failed else 0


def _print_result(result: BatchResult, as_json: bool) -> None:
    if as_json:
        print_json(
            {
                "ok": not result.failed,
                "files": len(result.records),
                "unchanged": result.unchanged,
                "failed": result.failed,
                "summary": str(result.table),
                "page": str(result.page),
                "rows": summary_rows(result.records),
            }
        )
        return
    print(f"{result.summary} Summary: {result.table}, {result.page}")
