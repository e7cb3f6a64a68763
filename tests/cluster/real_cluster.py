"""A real scheduler with real worker processes on loopback, and runs that use it."""

import os
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import psutil
from distributed import Client

HERE = Path(__file__).parent


def processes_below(process):
    return [child.pid for child in psutil.Process(process.pid).children(recursive=True)]


@dataclass
class Cluster:
    """A scheduler at ``address``; ``folder`` is where everything runs."""

    folder: Path
    environment: dict
    scheduler: subprocess.Popen
    address: str
    workers: list

    @classmethod
    def start(cls, folder, count=2):
        paths = [*(path for path in sys.path if path), str(HERE)]
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join(paths),
            "MEASURED": str(folder / "measured"),
            "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0",
        }
        file = folder / "scheduler.json"
        scheduler = subprocess.Popen(
            [
                *(sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard"),
                *("--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)),
            ],
            cwd=folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        workers = [
            subprocess.Popen(
                [
                    *(sys.executable, "-m", "distributed.cli.dask_worker", "--no-dashboard"),
                    *("--nthreads", "1", "--scheduler-file", str(file)),
                ],
                cwd=folder,
                env=environment,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            for _ in range(count)
        ]
        with Client(scheduler_file=str(file), timeout=300) as client:
            client.wait_for_workers(count, timeout=300)
            address = client.scheduler.address
        return cls(folder, environment, scheduler, address, workers)

    def stop(self):
        below = [pid for worker in self.workers for pid in processes_below(worker)]
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()
        for pid in below:
            if psutil.pid_exists(pid):
                psutil.Process(pid).kill()

    def start_sleepers(self, out):
        """Start the sweep of sleepers as a process of its own."""
        return subprocess.Popen(
            [
                sys.executable,
                str(HERE / "sweep_of_sleepers.py"),
                str(self.folder / out),
                self.address,
            ],
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def worker_pids(self):
        """Of the two processes that measure, below those that look after them."""
        with Client(self.address) as client:
            client.wait_for_workers(2, timeout=300)
            return list(client.run(os.getpid).values())

    def traced(self):
        """How often each point of the sweep of sleepers has been measured."""
        path = self.folder / "measured"
        return Counter(path.read_text().split()) if path.exists() else Counter()

    def wait_for_points(self, count):
        until = time.monotonic() + 300
        while len(self.traced()) < count and time.monotonic() < until:
            time.sleep(0.02)
