"""How long a cluster takes: 10,000 scans, and one volume of 8192^3 voxels, on paper from what is measured here.

    target/oracles/bin/python experiments/clusters/sizing.py     # minutes; prints the tables of docs/clusters.md

Measured: seconds of a block and bytes of its partial sum, of a network and of a hollow body; seconds of a merge; seconds
of a task that does nothing, which is what Dask's scheduler takes; seconds of a scan. Simulated: so many workers of one
thread each, which take the next task as they become free; a store that gives each a share of its bandwidth; a scheduler that
hands out one task after the other. Not in it: workers that die, a file system that others use, compression.
"""

import heapq
import json
import pathlib
import statistics
import tempfile
import time

import nibabel
import numpy as np
import zarr
from distributed import Client, LocalCluster

import surfometry
import surfometry.dask as blocks

SIDE = 256  # of a block, voxels
VOLUME = 8192
SCANS = 10_000
BANDWIDTH = 2e9  # bytes a second that the store gives to all together
SPACING = (0.061, 0.061, 0.061)


def network(shape):
    """A gyroid of period 40 voxels: a third of all tiles' voxels near a surface, as of bone at 61 micrometres."""
    z, y, x = np.ogrid[: shape[0], : shape[1], : shape[2]]
    z, y, x = (2 * np.pi / 40 * axis.astype(np.float32) for axis in (z, y, x))
    return (np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x) < -0.3).astype(np.uint8)


def seconds(call, times=3):
    """Median of a few, of the processor's time: what else a machine does is not in it."""
    taken = []
    for _ in range(times):
        start = time.process_time()
        call()
        taken.append(time.process_time() - start)
    return statistics.median(taken)


def costs_of_blocks(folder):
    """Seconds, bytes of a partial sum, bytes read: of a block inside a network, and of an empty one; of a merge."""
    image = zarr.create_array(str(folder / "v.zarr"), shape=(3 * SIDE,) * 3, chunks=(64,) * 3, dtype="u1", compressors=None)
    image[:, :, : 2 * SIDE] = network((3 * SIDE, 3 * SIDE, 2 * SIDE))
    run = blocks._Run.of(blocks._volume_of(image, None, None), SPACING, {}, {}, SIDE, None)
    spec = blocks._Spec(run.volume, run.spec.shape, run.spec.block, run.spec.options, "v", {}, 1)
    inside, empty = 13, 17
    lower, upper = spec.needed(spec.blocks(), inside)
    found = {
        "block_s": seconds(lambda: blocks._partial(spec, inside)),
        "empty_block_s": seconds(lambda: blocks._partial(spec, empty)),
        "read_bytes": int(np.prod(np.subtract(upper, lower))),
        "partial_bytes": len(blocks._partial(spec, inside)),
    }
    partials = [blocks._partial(spec, number) for number in range(16)]
    found["merge_s"] = seconds(lambda: blocks._core.merged(partials)) / len(partials)
    found["merged_bytes"] = len(blocks._core.merged(partials))
    return found


def cost_of_a_task():
    """Seconds that client and scheduler, which are in this process, take for a task."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.gather(client.map(abs, range(100)))
        return seconds(lambda: client.gather(client.map(abs, range(2000), pure=False))) / 2000


def cost_of_a_scan(folder):
    """Seconds of a scan of 100 million voxels full of a network, by one thread, read from a compressed file."""
    path = str(folder / "scan.nii.gz")
    image = nibabel.Nifti1Image(network((384, 512, 512)).T, np.diag([*SPACING, 1]))
    nibabel.save(image, path)
    return seconds(lambda: surfometry.measure_labels(path, as_frame=False, threads=1))


def makespan(durations, workers, handing_out):
    """Seconds until the last task has ended; each is handed out by one scheduler."""
    free = [0.0] * workers
    handed = 0.0
    for duration in durations:
        handed = max(handed + handing_out, heapq.heappop(free))
        heapq.heappush(free, handed + duration)
    return max(free)


def volume_on_paper(costs, task, workers, dense):
    """Hours for 8192^3, a share of whose blocks holds the network."""
    count = (VOLUME // SIDE) ** 3
    rng = np.random.default_rng(1)
    is_dense = rng.random(count) < dense
    reading = costs["read_bytes"] * workers / BANDWIDTH
    durations = reading + np.where(is_dense, costs["block_s"], costs["empty_block_s"])
    merges = count / 15 * 16 * costs["merge_s"] / workers
    return (makespan(durations, workers, task) + merges) / 3600


def cohort_on_paper(scan, task, workers, shards):
    """Hours for all scans, whose costs differ threefold: by shards, and by a scheduler."""
    rng = np.random.default_rng(2)
    durations = scan * rng.lognormal(-0.125, 0.5, SCANS)
    by_shards = max(durations[first::shards].sum() for first in range(shards))
    return by_shards / 3600, makespan(durations, workers, task) / 3600


def main():
    with tempfile.TemporaryDirectory() as folder:
        costs, scan = costs_of_blocks(pathlib.Path(folder)), cost_of_a_scan(pathlib.Path(folder))
    task = cost_of_a_task()
    print(json.dumps({**costs, "task_s": task, "scan_s": scan}, indent=1))
    count = (VOLUME // SIDE) ** 3
    moved = count * costs["read_bytes"]
    print(f"8192^3: {count} blocks, {moved / 1e12:.2f} TB read, {count * costs['partial_bytes'] / 1e6:.0f} MB of partial sums")
    for dense in (0.1, 1.0):
        for workers in (16, 128, 512):
            print(f"  {dense:4.0%} network, {workers} workers: {volume_on_paper(costs, task, workers, dense):.2f} h")
    for workers in (2, 16, 128):
        shards, dynamic = cohort_on_paper(scan, task, workers, workers)
        print(f"{SCANS} scans, {workers} workers: {shards:.2f} h by shards, {dynamic:.2f} h by Dask")


if __name__ == "__main__":
    main()
