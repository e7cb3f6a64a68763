"""Machine code on disk: of the sources as they are, compiled once, and never fatal."""

from bcre_ca.kept import kept
from bcre_ca.line import kernels as line
from bcre_ca.line.kernels import bounds
from bcre_ca.plane import kernels as plane
from bcre_ca.sources import FOLDER, digest_of


def file_of(compiled):
    """Where its machine code for (float64, float64) would be kept."""
    key = compiled._cache._index_key(("float64",) * 2, compiled.targetctx.codegen())
    return compiled._cache.files.path(key)


def test_machine_code_of_other_sources_lies_in_other_files():
    files = [file_of(kept(bounds.stable_steps, sources)) for sources in ("one", "one", "other")]
    assert files[0] == files[1] != files[2]


def test_functions_in_use_are_kept_by_the_digest_of_the_sources():
    for used in (line._march, line._march_frozen, line._follow, line._stable_steps):
        assert file_of(used) == file_of(kept(used.py_func, digest_of(FOLDER)))
    for used in (plane.take_steps, plane.extremes):
        assert file_of(used) == file_of(kept(used.py_func, digest_of(FOLDER)))


def test_digest_follows_every_source_file(tmp_path):
    (tmp_path / "kernels").mkdir()
    files = [tmp_path / "exchange.py", tmp_path / "kernels" / "sweep.py"]
    for file in files:
        file.write_text("x = 1\n")
    digests = [digest_of(tmp_path)]
    for file in files:
        file.write_text("x = 2\n")
        digests.append(digest_of(tmp_path))
    assert len(set(digests)) == 3
