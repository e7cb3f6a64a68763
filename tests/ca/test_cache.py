"""No machine code kept on disk outlives the sources it was compiled from."""

from bcre_ca.line import kernels
from bcre_ca.line.kernels import driver


def keys(entries):
    """Under which machine code for (float64, float64) would be kept, by the entry's name."""
    signature = ("float64", "float64")
    return {
        name: entry._cache._index_key(signature, entry.targetctx.codegen())
        for name, entry in vars(entries).items()
    }


def test_other_sources_are_kept_under_other_keys():
    one, again, other = (keys(driver.entries(sources)) for sources in ("one", "one", "other"))
    assert one == again
    assert set(one) == {"march", "march_many", "march_frozen", "follow", "bound"}
    assert all(one[name] != other[name] for name in one)


def test_functions_in_use_are_keyed_by_the_digest_of_the_sources():
    assert keys(kernels._compiled) == keys(driver.entries(kernels._digest()))


def test_digest_follows_every_source_file_of_the_automaton(tmp_path, monkeypatch):
    files = [tmp_path / name for name in ("exchange.py", "line/step.py", "line/kernels/sweep.py")]
    (tmp_path / "line" / "kernels").mkdir(parents=True)
    for file in files:
        file.write_text("x = 1\n")
    monkeypatch.setattr(kernels, "__file__", str(tmp_path / "line" / "kernels" / "__init__.py"))
    digests = [kernels._digest()]
    for file in files:
        file.write_text("x = 2\n")
        digests.append(kernels._digest())
    assert len(set(digests)) == 4
