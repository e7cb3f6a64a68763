"""No machine code kept on disk outlives the sources it was compiled from."""

from bcre_ca.plane import kernels
from bcre_ca.plane.kernels import bounds
from bcre_ca.plane.kernels.kept import SOURCES, digest_of, kept


def file_of(compiled):
    return compiled._cache._cache_file._index_name


def test_machine_code_of_other_sources_lies_in_other_files():
    files = [file_of(kept(bounds.extremes, sources)) for sources in ("one", "one", "other")]
    assert files[0] == files[1] != files[2]


def test_functions_in_use_are_named_by_the_digest_of_the_sources():
    digest = digest_of(SOURCES)[:16]
    assert digest in file_of(kernels.take_steps)
    assert digest in file_of(kernels.extremes)
    assert (SOURCES / "plane" / "kernels" / "march.py").exists()
    assert (SOURCES / "rule.py").exists()


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
