"""Runs on Dask distributed: a local cluster, or any whose workers have the program."""

import logging
import time
from contextlib import contextmanager

import dask
import explore
from distributed import CancelledError, Client, KilledWorker, LocalCluster, TimeoutError, wait

WAIT_FOR_WORKERS = 60  # [s]
WAIT_FOR_OTHERS = 1800  # [s], after the last worker has left
LOST_WORKERS = 3  # a run whose worker has died more often is lost
MOST_LOST = 10  # runs in a row that machines may lose: one that cannot make any would soon lose all


@contextmanager
def connect(scheduler, workers, folder):
    """A client; without a scheduler's address of so many single-threaded workers on this machine."""
    dask.config.set({"distributed.scheduler.allowed-failures": LOST_WORKERS,
                     # A busy machine takes a while to start another worker, and none would come after the usual 15 s.
                     "distributed.deploy.lost-worker-timeout": "10 minutes",
                     "distributed.comm.timeouts.connect": "10s",
                     # Each process would take a twentieth of a core to watch itself.
                     "distributed.worker.profile.enabled": False, "distributed.admin.tick.interval": "1s"})
    for name in ("distributed", "tornado.application"):  # they report lost workers, and so do we
        logging.getLogger(name).setLevel(logging.CRITICAL)
    if scheduler:
        try:
            client = Client(scheduler, timeout=10)
        except (OSError, TimeoutError, ValueError) as error:
            raise OSError(f"no scheduler answers at {scheduler}: start one with dask-scheduler ({error})") from error
        with client:
            client.upload_file(explore.__file__)
            try:
                client.wait_for_workers(1, timeout=WAIT_FOR_WORKERS)
            except TimeoutError as error:
                raise OSError(f"no worker at {scheduler} within {WAIT_FOR_WORKERS} s: start some with "
                              f"dask-worker {scheduler} --nthreads 1") from error
            yield client
        return
    folder.mkdir(parents=True, exist_ok=True)
    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address="127.0.0.1:0",
                      local_directory=str(folder), silence_logs=logging.CRITICAL) as cluster, Client(cluster) as client:
        client.upload_file(explore.__file__)
        yield client


def run_all(client, calls, until=None):
    """Yields (key, what explore() returns) as runs end, in any order; {"lost": why} is of a run that its machine could
    not make, which says nothing of the run. `calls`: {key: arguments of explore()}, begun in this order; none is begun
    after `until` (of time.monotonic()). No more runs are handed out than there are threads: a worker that dies takes
    none with it that it has not begun. Raises OSError if the machines lose run after run, or all leave for long."""
    waiting, begun, lost, last_seen = list(calls.items()), {}, 0, time.monotonic()
    while waiting or begun:
        threads = sum(client.nthreads().values())
        if threads:
            last_seen = time.monotonic()
        elif time.monotonic() > last_seen + WAIT_FOR_OTHERS:
            raise OSError(f"all workers have left {WAIT_FOR_OTHERS} s ago; start some, and the same command goes on")
        late = until is not None and time.monotonic() >= until
        while waiting and not late and len(begun) < max(threads, 1):
            key, arguments = waiting.pop(0)
            future = client.submit(explore.explore_on_worker, *arguments, key=f"{key}-{time.time_ns()}", pure=False)
            begun[future] = key
        if not begun:
            return
        try:
            done = wait(list(begun), timeout=5, return_when="FIRST_COMPLETED").done
        except TimeoutError:
            continue
        for future in done:
            key = begun.pop(future)
            try:
                result = future.result()
            except KilledWorker:
                result = {"lost": "its worker died again and again"}
            except CancelledError as error:
                raise OSError("the scheduler is gone; the same command goes on") from error
            except OSError as error:
                result = {"lost": str(error)}
            yield key, result
            lost = lost + 1 if "lost" in result else 0
            if lost == MOST_LOST:
                raise OSError(f"{lost} runs in a row were lost: {result['lost']}")
