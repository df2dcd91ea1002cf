"""Volumes in blocks and cohorts on Dask: the bits of the same in memory, whatever the blocks, the chunks and who dies."""

import csv
import os
import signal
import threading
import time
import warnings

import numpy as np
import pytest
from conftest import numbers

import surfometry

pytest.importorskip("dask")
pytest.importorskip("zarr")
import dask.array  # noqa: E402
import surfometry.dask  # noqa: E402
import zarr  # noqa: E402
from distributed import Client, LocalCluster  # noqa: E402

SHAPE = (152, 133, 171)
SPACING = (1.1, 0.9, 0.8)


@pytest.fixture(scope="module")
def labels():
    """Bodies across many blocks, turned: a network, a torus, thin rods that the blur loses, a speck, a cut ellipsoid."""
    z, y, x = np.meshgrid(*[np.arange(n) * h for n, h in zip(SHAPE, SPACING)], indexing="ij")
    volume = np.zeros(SHAPE, dtype=np.uint16)
    network = np.sin(x / 5 + 0.3) * np.cos(y / 5) + np.sin(y / 5) * np.cos(z / 5) + np.sin(z / 5) * np.cos(x / 5)
    # Recovered, which takes as long as it has faces.
    volume[(network < 0) & (x < 70) & (y < 70) & (z < 90)] = 7
    u, v, w = x - 102, 0.8 * (y - 60) + 0.6 * (z - 70), -0.6 * (y - 60) + 0.8 * (z - 70)
    volume[(np.hypot(u, v) - 24) ** 2 + w**2 < 8**2] = 300
    for number in range(4):
        along, across = 0.6 * u + 0.8 * v, 0.8 * u - 0.6 * v
        rod = (across - 8 * number + 12) ** 2 + (w - 40) ** 2 < 1.6**2
        volume[rod & (np.abs(along) < 17)] = 20 + number
    volume[3, 4, 170] = 2
    volume[((x - 130) / 20) ** 2 + ((y - 100) / 15) ** 2 + ((z - 150) / 25) ** 2 < 1] = 41
    return volume


@pytest.fixture(scope="module")
def in_memory(labels):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", surfometry.SurfometryWarning)
        return timeless(surfometry.measure_labels(labels, SPACING, as_frame=False))


@pytest.fixture(scope="module")
def client():
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        yield client


def timeless(columns):
    """Columns without times and the name of the image."""
    return {name: values for name, values in columns.items() if "seconds" not in name and name != "input"}


def stored(folder, labels, chunks, version):
    array = zarr.create_array(
        str(folder / f"v{version}.zarr"), shape=labels.shape, chunks=chunks, dtype=labels.dtype, zarr_format=version
    )
    array[:] = labels
    return folder / f"v{version}.zarr"


@pytest.mark.parametrize(
    ("version", "chunks", "block"), [(2, (40, 33, 64), None), (3, (64, 64, 64), 64), (3, (152, 7, 171), (50, 61, 100))]
)
def test_the_bits_of_the_volume_in_memory(labels, in_memory, client, tmp_path, version, chunks, block):
    path = stored(tmp_path, labels, chunks, version)
    found = surfometry.dask.measure_labels(path, SPACING, as_frame=False, block=block, client=client)
    assert timeless(found) == in_memory
    # The rods were looked at as wholes: the second pass is in the test.
    assert "recovering" in found["parameters_embedding"] and "gaussian" in found["parameters_embedding"]
    assert found["topology_euler_characteristic_voxels_26"][found["label"].index(300)] == 0


def test_without_a_client_and_of_arrays(labels, in_memory, tmp_path):
    path = stored(tmp_path, labels, (50, 50, 60), 3)
    opened = zarr.open_array(str(path), mode="r")
    here = surfometry.dask._client
    for image in (opened, dask.array.from_array(labels, chunks=(60, 133, 64)), dask.array.from_zarr(str(path))[None]):
        surfometry.dask._client = lambda client: None
        try:
            found = surfometry.dask.measure_labels(image, SPACING, as_frame=False, block=(64, 64, 128))
        finally:
            surfometry.dask._client = here
        assert timeless(found) == in_memory


def test_one_object_and_choices_of_ones_own(labels, client, tmp_path):
    path = stored(tmp_path, labels, (64, 64, 64), 2)
    for choices in ({"label": 300}, {"label": (7, 300), "sigma": 2.1}, {"label": 20, "embedding": "corrected"}):
        ours = surfometry.dask.measure(path, SPACING, client=client, block=64, **choices)
        assert numbers(ours) == numbers(surfometry.measure(labels, SPACING, **choices)), choices
    explained = surfometry.dask.measure(path, SPACING, client=client, block=64, label=7, explain=True)
    assert numbers(explained) == numbers(surfometry.measure(labels, SPACING, label=7, explain=True))


def test_a_dead_worker_changes_no_bit(labels, in_memory, client, tmp_path):
    path = stored(tmp_path, labels, (32, 32, 32), 3)
    dead = []

    def kill():
        # In the midst: a few of some hundred blocks are done.
        time.sleep(0.3)
        dead.append(next(iter(client.run(os.getpid).values())))
        os.kill(dead[0], signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    found = surfometry.dask.measure_labels(path, SPACING, as_frame=False, block=32, client=client)
    ended_before = not dead
    killer.join()
    assert not ended_before, "the run ended before a worker was killed"
    assert timeless(found) == in_memory
    client.wait_for_workers(2)


def test_what_a_task_is_sent_and_gives_back(labels, client, tmp_path, monkeypatch):
    path = stored(tmp_path, labels, (32, 32, 32), 3)
    sent = []
    send = client._send_to_scheduler

    def noted(message):
        if "expr_ser" in message:
            sent.append(len(message["expr_ser"].header) + sum(map(len, message["expr_ser"].frames)))
        return send(message)

    monkeypatch.setattr(client, "_send_to_scheduler", noted)
    surfometry.dask.measure_labels(path, SPACING, label=300, as_frame=False, block=19, client=client)
    count = int(np.prod([-(-n // 19) for n in SHAPE]))
    print(f"{sent[0] / count:.1f} bytes a block")
    assert count > 500 and sent[0] < 100 * count
    run = surfometry.dask._Run.of(surfometry.dask._volume_of(path, None, None), SPACING, {}, {}, 64, None)
    largest = max(len(surfometry.dask._partial(run.spec, number)) for number in range(int(np.prod(run.spec.lattice))))
    print(f"{largest} bytes of a partial sum at most")
    assert largest < 64**3 / 4


def test_what_cannot_be_measured_in_blocks_is_refused(labels, tmp_path):
    path = stored(tmp_path, labels, (64, 64, 64), 3)
    for choices, words in [
        ({"embedding": "recovering"}, "wholes"),
        ({"embedding": "given"}, "labels"),
        ({"sigma": {7: 1.5}}, "labels of their own"),
        ({"label": 99}, "99"),
        ({"block": 0}, "block"),
    ]:
        with pytest.raises(ValueError, match=words):
            surfometry.dask.measure_labels(path, SPACING, **choices)
    with pytest.raises(surfometry.InputError, match="spacing="):
        surfometry.dask.measure(path)
    with pytest.raises(surfometry.InputError, match="objects"):
        surfometry.dask.measure(path, SPACING)
    with pytest.raises(surfometry.InputError, match=r"nowhere\.zarr"):
        surfometry.dask.measure(tmp_path / "nowhere.zarr", 1)
    with pytest.raises(TypeError, match="no chunks"):
        surfometry.dask.measure(labels, 1)
    zarr.create_group(str(tmp_path / "group.zarr")).create_array("bone", shape=(8, 8, 8), dtype="u1")
    with pytest.raises(surfometry.InputError, match="bone"):
        surfometry.dask.measure(tmp_path / "group.zarr", 1)
    field = dask.array.from_array(np.full((40, 40, 40), 0.5), chunks=20)
    with pytest.raises(surfometry.InputError, match="whole"):
        surfometry.dask.measure(field, 1)
    with pytest.raises(surfometry.InputError, match="one 3-D image"):
        surfometry.dask.measure(dask.array.zeros((2, 8, 8, 8), chunks=8), 1)
    masked = dask.array.ma.masked_equal(dask.array.from_array(labels, chunks=64), labels.max())
    with pytest.raises(surfometry.InputError, match="masked"):
        surfometry.dask.measure_labels(masked, SPACING)


def test_a_cohort_whose_workers_die(client, tmp_path):
    inputs = [f"phantom:torus?major={9 + n % 5}&minor=4&rotate=20,{n},40&spacing=0.9,1,1.1" for n in range(40)]
    inputs.insert(5, "missing.nii")

    def kill():
        time.sleep(0.5)
        os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    found = surfometry.dask.cohort(inputs, tmp_path / "dask.csv", client=client)
    killer.join()
    here = surfometry.cohort(inputs, tmp_path / "here.csv")
    assert (found.rows, list(found.failures)) == (here.rows, ["missing.nii"]) and found.failures == here.failures
    tables = []
    for name in ("dask.csv", "here.csv"):
        with open(tmp_path / name, newline="", encoding="utf-8") as table:
            tables.append([{k: v for k, v in row.items() if "seconds" not in k} for row in csv.DictReader(table)])
    assert tables[0] == tables[1]
    # Either goes on with what the other has: nothing is measured, so that times are the same.
    before = (tmp_path / "dask.csv").read_text(encoding="utf-8")
    surfometry.cohort(inputs, tmp_path / "dask.csv")
    assert (tmp_path / "dask.csv").read_text(encoding="utf-8") == before
