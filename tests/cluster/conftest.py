"""The cluster that the tests share."""

import pytest
from real_cluster import Cluster


@pytest.fixture(scope="session")
def running(tmp_path_factory):
    cluster = Cluster.start(tmp_path_factory.mktemp("cluster"))
    yield cluster
    cluster.stop()


@pytest.fixture
def cluster(running):
    """The running cluster, its trace empty and two workers there."""
    (running.folder / "measured").unlink(missing_ok=True)
    running.worker_pids()
    return running
