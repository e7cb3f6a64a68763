"""No machine code on disk outlives the sources it was compiled from."""

from pathlib import Path

import bcre_pde
from bcre_pde import kept
from bcre_pde.line import fluxes


def keys(compiled):
    """Under which machine code for (float64,) would be kept."""
    return [entry._cache._index_key(("float64",), entry.targetctx.codegen()) for entry in compiled]


def test_other_sources_are_kept_under_other_keys():
    one, same, other = (keys(fluxes.entries(sources)) for sources in ("one", "one", "other"))
    assert one == same
    assert all(a != b for a, b in zip(one, other, strict=True))


def test_functions_in_use_are_keyed_by_all_sources_of_the_package():
    folder = Path(bcre_pde.__file__).parent
    assert keys((fluxes.rate, fluxes.march)) == keys(fluxes.entries(kept.digest(folder)))


def test_digest_follows_every_source_file(tmp_path):
    files = [tmp_path / "exchange.py", tmp_path / "line" / "fluxes.py"]
    files[1].parent.mkdir()
    digests = {kept.digest(tmp_path)}
    for file in files:
        for text in ("x = 1\n", "x = 2\n"):
            file.write_text(text)
            digests.add(kept.digest(tmp_path))
    assert len(digests) == 5
