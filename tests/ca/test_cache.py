"""No machine code kept on disk outlives the sources it was compiled from."""

from bcre_ca import kernels
from bcre_ca.kernels import driver
from bcre_ca.sources import FOLDER, digest_of


def keys(sources):
    """Under which machine code for (float64, float64) would be kept."""
    signature = ("float64", "float64")
    return [
        entry._cache._index_key(signature, entry.targetctx.codegen())
        for entry in driver.entries(sources)
    ]


def test_other_sources_are_kept_under_other_keys():
    assert keys("one") == keys("one")
    assert all(one != other for one, other in zip(keys("one"), keys("other"), strict=True))
    assert len(keys("one")) == 4


def test_functions_in_use_are_keyed_by_the_digest_of_the_sources():
    used = (kernels._fixed, kernels._followed, kernels._batch, kernels._bound)
    found = [entry._cache._index_key((), entry.targetctx.codegen()) for entry in used]
    expected = [
        entry._cache._index_key((), entry.targetctx.codegen())
        for entry in driver.entries(digest_of(FOLDER))
    ]
    assert found == expected
