"""Many runs on a cluster of several processes, one of which is killed; records in Parquet files."""

import os
import signal

import numpy as np
import pytest

import manutec_r3 as r3
from manutec_r3.files import parquet

distributed = pytest.importorskip("distributed", reason="needs the extra dask")
pq = pytest.importorskip("pyarrow.parquet", reason="needs the extra dask")

SIGNALS = r3.Result.signals[:-1]
robot = r3.Robot(model=3, load=r3.Load(mass=15.0))
T_END = 0.03
# All different, so that a result in a wrong place is seen.
RUNS = [(robot, r3.Hold([0.01 * k, 0.0, 0.0, 0.0, 0.0, 0.0])) for k in range(24)]


@pytest.fixture(scope="module")
def client():
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def assert_same(one, other):
    assert type(one) is type(other)
    assert (one.t_end, one.status) == (other.t_end, other.status)
    for name in SIGNALS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize("record", ["all", "final", "peaks"])
def test_a_cluster_gives_what_one_machine_gives(client, record):
    told = []
    there = r3.simulate_many(RUNS, T_END, record=record, client=client, progress=told.append)
    for one, other in zip(there, r3.simulate_many(RUNS, T_END, record=record), strict=True):
        assert_same(one, other)
    assert told[-1] == len(RUNS)


def test_what_a_killed_worker_loses_is_done_by_others(client):
    long = [(robot, r3.Hold([0.01 * k, -0.5, 0.8, 0, 0, 0])) for k in range(32)]
    killed = []

    def kill_one(n_finished):
        if not killed:
            killed.append(client.run(os.getpid))
            os.kill(next(iter(killed[0].values())), signal.SIGKILL)

    there = r3.simulate_many(long, 0.3, record="final", client=client, progress=kill_one)
    assert len(killed) == 1
    assert there.failures == {}
    for one, other in zip(there, r3.simulate_many(long, 0.3, record="final"), strict=True):
        assert_same(one, other)


def test_a_run_that_fails_on_a_cluster_stands_in_its_place(client):
    start = robot.state_from([0.0] * 6, joint_rate=[1e100] * 6)
    bad = r3.Scenario("bad", *RUNS[0], T_END, start=start)
    there = r3.simulate_many([RUNS[0], bad, RUNS[2]], T_END, record="final", client=client)
    assert list(there.failures) == [1]
    assert isinstance(there[1], r3.SimulationError)
    assert there[1].result.t_end == 0.0


def test_arguments_reach_the_workers(client):
    arguments = {"rtol": 1e-9, "start": "arm", "tip_force": [0.0, 0.0, -50.0], "record": "final"}
    (there,) = r3.simulate_many(RUNS[:1], T_END, client=client, **arguments)
    (here,) = r3.simulate_many(RUNS[:1], T_END, **arguments)
    assert_same(there, here)


def test_what_progress_raises_ends_the_work_on_a_cluster_and_keeps_what_is_finished(client):
    def enough(n_finished):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough") as stopped:
        r3.simulate_many(RUNS, T_END, record="final", client=client, progress=enough)
    results = stopped.value.results
    assert 0 < results.n_finished < len(RUNS)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"client": "localhost"}, "client: expected a distributed.Client, got 'localhost'"),
        ({"to_parquet": "new"}, "to_parquet: expected record='events', 'final' or 'peaks'"),
        ({"to_parquet": ".", "record": "final"}, "to_parquet: expected a folder that is not there"),
    ],
)
def test_what_is_wrong_is_told(arguments, message):
    with pytest.raises((TypeError, ValueError), match=message):
        r3.simulate_many(RUNS, T_END, **arguments)


def test_workers_are_those_of_the_cluster(client):
    with pytest.raises(ValueError, match="workers: expected none with a client"):
        r3.simulate_many(RUNS, T_END, client=client, workers=2)


# --- Parquet ------------------------------------------------------------------------------------


@pytest.mark.parametrize("record", ["events", "final", "peaks"])
@pytest.mark.parametrize("where", ["here", "cluster"])
def test_parquet_files_have_a_row_for_each_run_in_order(
    request, tmp_path, monkeypatch, record, where
):
    monkeypatch.setattr(parquet, "ROWS", 10)  # more than one file
    engine = {"client": request.getfixturevalue("client")} if where == "cluster" else {}
    folder = tmp_path / "records"
    told = []
    arguments = {"record": record, "to_parquet": folder, "progress": told.append}
    assert r3.simulate_many(RUNS, T_END, **arguments, **engine) == folder
    assert told[-1] == len(RUNS)
    assert len(list(folder.iterdir())) > 1
    rows = pq.read_table(folder).to_pylist()
    assert [row["run"] for row in rows] == list(range(len(RUNS)))
    for row, kept in zip(rows, r3.simulate_many(RUNS, T_END, record=record), strict=True):
        assert row["status"] == "completed"
        assert row["t_end"] == T_END
        assert row["evaluations"] == kept.statistics.evaluations
        if record == "events":
            assert row["event_time"] == kept.events.time.tolist()
            assert row["event_element"] == kept.events.element.tolist()
            continue
        for name in SIGNALS:
            np.testing.assert_array_equal(row[name], getattr(kept, name))
        if record == "final":
            np.testing.assert_array_equal(row["state"], kept.state)
            np.testing.assert_array_equal(row["branches_friction"], kept.branches["friction"])


def test_a_run_that_fails_has_a_row_that_says_why(tmp_path):
    start = robot.state_from([0.0] * 6, joint_rate=[1e100] * 6)
    bad = r3.Scenario("bad", *RUNS[0], T_END, start=start)
    heavy = r3.Robot(model=3, load=r3.Load(200.0, bounds=False))
    runs = [bad, (heavy, r3.Hold([0.0, 1.5, 0.0, 0.0, 0.0, 0.0])), RUNS[0]]
    folder = r3.simulate_many(runs, T_END, record="peaks", to_parquet=tmp_path / "records")
    failed, refused, good = pq.read_table(folder).to_pylist()
    assert failed["status"].startswith("failed at 0 s: ")
    assert failed["t_end"] == 0.0
    assert refused["status"].startswith("ValueError: ")
    assert refused["t_end"] is None
    assert good["status"] == "completed"


def test_rows_that_are_finished_are_kept_when_the_work_is_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr(parquet, "ROWS", 10)

    def enough(n_finished):
        if n_finished >= 10:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError) as stopped:
        r3.simulate_many(
            RUNS, T_END, record="final", to_parquet=tmp_path / "records", progress=enough
        )
    rows = pq.read_table(stopped.value.results).to_pylist()
    assert [row["run"] for row in rows][:10] == list(range(10))
    assert len(rows) < len(RUNS)
