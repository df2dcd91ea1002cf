"""Measured in workers of a data loader: forked from a process that has measured, with threads of its own, asked by queues.

PyTorch's wheels are large, so that its own loader is tested where it is installed; `Loader` does what its workers do.
"""

import functools
import multiprocessing
import os
import queue
import signal
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from conftest import SPACING, numbers, turned_body

import surfometry

SIZES = range(4)
PATIENCE = 90


class Bodies:
    """A data set of bodies of several sizes, measured where they are fetched."""

    def __len__(self):
        return len(SIZES)

    def __getitem__(self, index):
        body = np.roll(turned_body(), index, axis=2)
        measured = surfometry.measure(body, SPACING)
        return numbers(measured), os.getpid()


@functools.cache
def expected():
    return [numbers(surfometry.measure(np.roll(turned_body(), index, axis=2), SPACING)) for index in SIZES]


def work(dataset, index_queue, data_queue, done):
    """The loop of torch.utils.data._utils.worker: indices in, samples out, until None comes."""
    while (index := index_queue.get()) is not None:
        try:
            data_queue.put((index, dataset[index]))
        except Exception as error:
            data_queue.put((index, error))
    done.set()


class Loader:
    """Workers as `torch.utils.data.DataLoader` has them: a queue of indices each, one queue of samples that a thread empties."""

    def __init__(self, dataset, method, workers=2):
        context = multiprocessing.get_context(method)
        self.samples, self.fetched = context.Queue(), queue.Queue()
        self.workers = []
        for _ in range(workers):
            indices, done = context.Queue(), context.Event()
            arguments = (dataset, indices, self.samples, done)
            worker = context.Process(target=work, args=arguments, daemon=True)
            worker.start()
            self.workers.append((worker, indices, done))
        threading.Thread(target=self._pin, daemon=True).start()

    def _pin(self):
        """The thread that pins memory, beside those of the measurements."""
        while (sample := self.samples.get()) is not None:
            self.fetched.put(sample)

    def __call__(self, indices):
        for order, index in enumerate(indices):
            self.workers[order % len(self.workers)][1].put(index)
        found = dict(self.fetched.get(timeout=PATIENCE) for _ in indices)
        return [found[index] for index in indices]

    def close(self):
        self.samples.put(None)
        for worker, indices, _ in self.workers:
            indices.put(None)
            worker.join(PATIENCE)
        assert [worker.exitcode for worker, _, _ in self.workers] == [0] * len(self.workers)
        assert all(done.is_set() for _, _, done in self.workers)


@pytest.fixture(params=["fork", "forkserver", "spawn"])
def loader(request):
    # What a fork must survive: this process has measured, in a pool of its own, and other threads measure while it forks.
    surfometry.measure(turned_body(), SPACING, threads=2)
    with ThreadPoolExecutor(2) as threads:
        busy = [threads.submit(surfometry.sweep, turned_body(), [1.5, 2.0, 2.5], SPACING) for _ in range(2)]
        loader = Loader(Bodies(), request.param)
        yield loader
        loader.close()
        assert all(len(done.result(timeout=PATIENCE)) == 3 for done in busy)


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_workers_of_a_loader_give_the_same_bits(loader):
    found = loader(list(SIZES))
    assert [numbers for numbers, _ in found] == expected()
    assert len({process for _, process in found}) == 2 and os.getpid() not in {process for _, process in found}
    # A second epoch, by the same workers.
    assert [numbers for numbers, _ in loader(list(SIZES)[::-1])] == expected()[::-1]


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_worker_measures_in_threads_of_its_own():
    """Threads of torch's in a worker are as many as it is told; ours work beside them."""
    context = multiprocessing.get_context("fork")
    answers = context.Queue()

    def measure_in_threads():
        with ThreadPoolExecutor(3) as threads:
            answers.put(list(threads.map(lambda count: numbers(surfometry.measure(turned_body(), SPACING, threads=count)), [1, 2, 4])))

    worker = context.Process(target=measure_in_threads)
    worker.start()
    try:
        found = answers.get(timeout=PATIENCE)
    finally:
        worker.join(10)
        if worker.is_alive():
            os.kill(worker.pid, signal.SIGKILL)
    assert found == [numbers(surfometry.measure(turned_body(), SPACING))] * 3


class Broken(Bodies):
    def __getitem__(self, index):
        return surfometry.measure(np.zeros((4, 5), np.uint8), SPACING)


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_an_error_comes_back_from_a_worker_as_it_was_raised():
    loader = Loader(Broken(), "fork", workers=1)
    (error,) = loader([0])
    loader.close()
    assert isinstance(error, surfometry.InputError) and "shape (4, 5)" in str(error) and error.field == "image"


@pytest.mark.parametrize("method", ["fork", "forkserver", "spawn"])
def test_torch_data_loader(method):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed here: its wheels are large; Loader does what it does")
    surfometry.measure(turned_body(), SPACING)
    loader = torch.utils.data.DataLoader(
        Bodies(), batch_size=2, num_workers=2, multiprocessing_context=method, collate_fn=list, persistent_workers=True
    )
    for _ in range(2):
        found = [sample for batch in loader for sample in batch]
        assert [numbers for numbers, _ in found] == expected()
        assert os.getpid() not in {process for _, process in found}
