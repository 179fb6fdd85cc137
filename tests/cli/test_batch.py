"""`batch`: a folder of captures over processes; nothing is done twice, nothing is lost, one bad file stops nothing."""

import csv
import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from distributed import Client, LocalCluster

from studio.cli.main import main
from studio.core.markers.marker_map import MarkerMap
from studio.core.stage.placement import Placement
from studio.io.export import write_capture
from studio.io.importing import ImportOptions
from studio.jobs.adapted_files import AdaptSettings
from studio.jobs.batch import BatchResult, BatchSettings, FileDone, run_batch
from studio.jobs.batch_jobs import BatchJob, adapt_job, find_jobs, finished_record
from studio.jobs.batch_workers import can_fork
from tests.architecture.sources import ROOT
from tests.builders import make_capture

SETTINGS = AdaptSettings(characters=("child",))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three captures, one of them in a folder below, and a file that is none."""
    source = tmp_path / "captures"
    (source / "kicks").mkdir(parents=True)
    for seed, name in enumerate(("walk", "run", "kicks/walk")):
        write_capture(make_capture(seed=seed), source / f"{name}.bvh")
    (source / "notes.txt").write_text("not a capture")
    return source


def jobs_of(folder: Path, settings: AdaptSettings = SETTINGS) -> list[BatchJob]:
    return find_jobs(folder, folder.parent / "out", settings)


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder.parent / "out" / "summary.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def two_workers():
    """A real cluster on loopback, as somebody else would have started it."""
    with LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0", silence_logs=50
    ) as cluster:
        yield cluster


def command(folder: Path, cluster: LocalCluster, *more: str) -> list[str]:
    place = ["--out", str(folder.parent / "out"), "--scheduler", cluster.scheduler_address]
    return ["batch", str(folder), "--character", "child", *place, *more]


def settings_for(folder: Path, cluster: LocalCluster) -> BatchSettings:
    return BatchSettings(folder, folder.parent / "out", SETTINGS, scheduler=cluster.scheduler_address)


def test_each_capture_of_the_folder_and_those_below_is_a_job_and_what_was_written_is_none(folder):
    (folder / "out").mkdir()
    write_capture(make_capture(), folder / "out" / "walk_child.bvh")
    jobs = find_jobs(folder, folder / "out", SETTINGS)
    assert [job.name for job in jobs] == ["kicks/walk.bvh", "run.bvh", "walk.bvh"]
    assert len({job.folder for job in jobs}) == 2


def test_a_job_is_done_anew_only_when_something_that_matters_has_changed(folder):
    [_, _, job] = jobs_of(folder)
    assert finished_record(job) is None
    record = adapt_job(job)
    assert finished_record(job) == json.loads(json.dumps(record))
    assert finished_record(jobs_of(folder, replace(SETTINGS, reading=ImportOptions(unit="inch")))[2]) is None
    [written] = record["written"]
    Path(written).write_text("touched")
    assert finished_record(job) is None
    adapt_job(job)
    write_capture(make_capture(seed=7), folder / "walk.bvh")
    assert finished_record(jobs_of(folder)[2]) is None


def test_a_report_that_is_none_of_ours_is_no_reason_to_skip(folder):
    job = jobs_of(folder)[0]
    job.report.parent.mkdir(parents=True)
    for content in ("", "[]", '{"digest": 1}', '{"written": 3}'):
        job.report.write_text(content)
        assert finished_record(job) is None


def test_what_goes_wrong_is_a_record_of_that_file_alone(folder, monkeypatch):
    (folder / "walk.bvh").write_text("HIERARCHY\n")
    assert adapt_job(jobs_of(folder)[2])["error"] == "walk.bvh, line 1: the file ends before MOTION. It is cut off."
    monkeypatch.setattr("studio.jobs.batch_jobs.adapt_file", lambda *_: 1 / 0)
    assert "ZeroDivisionError" in adapt_job(jobs_of(folder)[0])["error"]


def test_files_of_one_name_and_several_kinds_do_not_overwrite_each_other(folder, monkeypatch):
    (folder / "walk.trace").write_text("trace 1\n")
    monkeypatch.setattr("studio.io.registry.KnownFormats.suffixes", lambda *_: (".bvh", ".trace"))
    folders = {job.name: job.folder.name for job in jobs_of(folder)}
    assert (folders["walk.bvh"], folders["walk.trace"], folders["run.bvh"]) == ("walk.bvh", "walk.trace", "out")


def test_a_folder_without_captures_and_a_missing_one_are_refused(tmp_path, capsys):
    assert main(["batch", str(tmp_path), "--out", str(tmp_path / "out")]) == 1
    assert "holds no captures" in capsys.readouterr().err
    assert main(["batch", str(tmp_path / "none"), "--out", str(tmp_path / "out")]) == 1
    assert "is not a folder" in capsys.readouterr().err


def test_the_folder_of_the_captures_and_one_with_files_of_somebody_else_are_not_written_to(folder, capsys):
    assert main(["batch", str(folder), "--out", str(folder), "--character", "child"]) == 1
    assert "holds the captures. Name another folder" in capsys.readouterr().err
    (folder.parent / "out").mkdir()
    (folder.parent / "out" / "walk_child.bvh").write_text("precious")
    assert main(["batch", str(folder), "--out", str(folder.parent / "out"), "--character", "child"]) == 1
    assert "--overwrite" in capsys.readouterr().err
    assert [path.name for path in (folder.parent / "out").iterdir()] == ["walk_child.bvh"]


def test_a_scheduler_that_does_not_answer_is_named(folder, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("studio.jobs.batch_cluster._PATIENCE", 0.5)
    address = "tcp://127.0.0.1:9"
    assert main(["batch", str(folder), "--out", str(tmp_path / "out"), "--scheduler", address]) == 1
    assert f"No scheduler answers at '{address}'" in capsys.readouterr().err


def test_a_second_run_skips_all_but_what_changed_and_a_bad_file_is_a_row(folder, two_workers, capsys):
    (folder / "broken.bvh").write_text("HIERARCHY\n")
    assert main(command(folder, two_workers, "--json")) == 1
    first = json.loads(capsys.readouterr().out)
    assert (first["files"], first["unchanged"], first["failed"]) == (4, 0, 1)
    write_capture(make_capture(seed=9), folder / "broken.bvh")
    write_capture(make_capture(seed=8), folder / "run.bvh")
    assert main(command(folder, two_workers, "--json")) == 0
    told = capsys.readouterr()
    assert json.loads(told.out)["unchanged"] == 2
    assert "[2/4] walk.bvh: unchanged" in told.err
    table = {row["capture"]: row for row in rows(folder)}
    assert set(table) == {"broken.bvh", "kicks/walk.bvh", "run.bvh", "walk.bvh"}
    assert all(float(row["slide_mm"]) >= 0.0 and float(row["seconds"]) > 0.0 for row in table.values())
    page = (folder.parent / "out" / "summary.html").read_text()
    assert page.count("<circle") >= 8
    assert "Contact sliding, mm" in page


def test_with_a_worker_killed_half_way_nothing_is_lost(folder, two_workers):
    for seed in range(12):
        write_capture(make_capture(seed=seed, frames=200), folder / f"take{seed}.bvh")
    with Client(two_workers.scheduler_address) as client:
        workers = client.run(os.getpid)
    killed: list[int] = []
    outcomes = []

    def kill_one(done: FileDone) -> None:
        outcomes.append(done.outcome)
        if done.number == 5:
            killed.append(next(iter(workers.values())))
            os.kill(killed[0], signal.SIGKILL)

    result = run_batch(settings_for(folder, two_workers), kill_one)
    assert (len(killed), result.failed) == (1, 0)
    assert outcomes == ["done"] * 15
    assert len(rows(folder)) == 15
    assert all(row["error"] == "" and Path(row["file"]).is_file() for row in rows(folder))
    assert all(finished_record(job) for job in find_jobs(folder, folder.parent / "out", SETTINGS))


def test_stopped_it_says_how_far_it_came_and_keeps_it(folder, two_workers, monkeypatch, capsys):
    def run_and_stop(settings: BatchSettings, told: Callable[[FileDone], object]) -> BatchResult:
        def tell(done: FileDone) -> None:
            told(done)
            if done.number == 2:
                raise KeyboardInterrupt

        return run_batch(settings, tell)

    monkeypatch.setattr("studio.cli.batch.run_batch", run_and_stop)
    assert main(command(folder, two_workers)) == 130
    assert "Stopped after 2 of 3 files" in capsys.readouterr().err
    assert len(rows(folder)) == 2


def test_without_a_scheduler_it_starts_workers_of_its_own_and_ends_them(folder, capsys):
    before = set(multiprocessing.active_children())
    assert main(["batch", str(folder), "--out", str(folder.parent / "out"), "--character", "child", "--workers=1"]) == 0
    assert "3 adapted, 0 unchanged, 0 failed" in capsys.readouterr().out
    assert set(multiprocessing.active_children()) <= before


def test_workers_that_are_new_processes_do_what_forks_do(folder, monkeypatch, capsys):
    """As on Windows and macOS."""
    monkeypatch.setattr("studio.jobs.batch_workers.can_fork", lambda: False)
    assert main(["batch", str(folder), "--out", str(folder.parent / "out"), "--character", "child", "--workers=1"]) == 0
    assert "3 adapted, 0 unchanged, 0 failed" in capsys.readouterr().out


@pytest.mark.skipif(not can_fork(), reason="elsewhere workers do not inherit what is replaced here")
def test_a_capture_of_which_workers_die_is_a_row_with_its_error_and_the_others_are_done(folder, monkeypatch, capsys):
    monkeypatch.setattr(
        "studio.jobs.batch_workers.adapt_job", lambda job: adapt_job(job) if "run" not in job.name else os._exit(9)
    )
    command = ["batch", str(folder), "--out", str(folder.parent / "out"), "--character", "child", "--workers", "2"]
    assert main(command) == 1
    assert "2 adapted, 0 unchanged, 1 failed" in capsys.readouterr().out
    errors = {row["capture"]: row["error"] for row in rows(folder)}
    assert "every worker that was given this file died of it" in errors.pop("run.bvh")
    assert set(errors.values()) == {""}


def test_ctrl_c_in_a_terminal_ends_the_batch_with_one_sentence(folder):
    for seed in range(9):
        write_capture(make_capture(seed=seed, frames=800), folder / f"take{seed}.bvh")
    command = [sys.executable, str(ROOT / "main.py"), "batch", str(folder), "--out", str(folder.parent / "out")]
    command += ["--character", "child"]
    # As a terminal starts it: who starts this test in the background has the signal ignored.
    heard = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, start_new_session=True, preexec_fn=heard
    ) as batch_process:
        told = batch_process.stderr.readline()
        os.killpg(batch_process.pid, signal.SIGINT)
        rest = batch_process.stderr.read()
    assert batch_process.returncode == 130
    assert told.startswith("[1/12]")
    last = [line for line in rest.splitlines() if not line.startswith("[")]
    assert len(last) == 1
    assert last[0].startswith("morpho-studio: Stopped after")
    assert not list(folder.parent.rglob("*.part"))


def test_from_another_thread_it_says_what_is_done_and_stops_when_told(folder):
    """As the window runs it: its workers are new processes, and what is done stays."""
    settings = BatchSettings(folder, folder.parent / "out", SETTINGS, workers=1)

    def stop(done: FileDone) -> None:
        raise InterruptedError(done.name)

    with ThreadPoolExecutor(1) as thread, pytest.raises(InterruptedError):
        thread.submit(run_batch, settings, stop).result()
    names: list[str] = []
    result = run_batch(settings, lambda done: names.append(done.outcome))
    assert (result.unchanged, result.adapted, result.failed) == (1, 2, 0)
    assert names == ["unchanged", "done", "done"]


def test_settings_with_maps_of_markers_and_joints_reach_another_process():
    reading = ImportOptions(marker_map=MarkerMap("own", {"collar": ("H1", "H2")}), body_map={"head": "Head"})
    settings = AdaptSettings(places={"child": Placement((1.0, 2.0), 0.5)}, reading=reading)
    assert pickle.loads(pickle.dumps(settings)) == settings
