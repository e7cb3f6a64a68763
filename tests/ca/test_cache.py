"""No machine code kept on disk outlives the sources it was compiled from."""

from bcre_ca import kernels
from bcre_ca.kernels import driver


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
        for entry in driver.entries(kernels._digest())
    ]
    assert found == expected


def test_digest_follows_every_source_file_of_the_automaton(tmp_path, monkeypatch):
    (tmp_path / "kernels").mkdir()
    files = [tmp_path / "exchange.py", tmp_path / "kernels" / "sweep.py"]
    for file in files:
        file.write_text("x = 1\n")
    monkeypatch.setattr(kernels, "__file__", str(tmp_path / "kernels" / "__init__.py"))
    digests = [kernels._digest()]
    for file in files:
        file.write_text("x = 2\n")
        digests.append(kernels._digest())
    assert len(set(digests)) == 3
