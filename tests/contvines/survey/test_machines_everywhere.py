"""A survey of coupled machines in one process, in two, and on a cluster that loses a worker half way: the same file; the large one is
`tools/benchmarks/survey.py`."""

import pytest

from tools.benchmarks.survey import ASKED, made, on_a_cluster, same

pytestmark = pytest.mark.slow

MACHINES = 2


def test_the_same_file_from_everywhere(tmp_path, monkeypatch):
    monkeypatch.setitem(ASKED, "depth", 0)  # of the large one 1
    pytest.importorskip("distributed")
    pytest.importorskip("xarray")
    one, _ = made(tmp_path, "one", MACHINES, workers=1)
    assert one.failed == 0 and one["peak"].size == MACHINES
    assert same(one, made(tmp_path, "two", MACHINES, workers=2)[0])
    assert same(one, on_a_cluster(tmp_path, MACHINES))
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "cluster.nc").read_bytes()
