"""What the command writes: over nothing that it reads, as a user's own files are written."""

import errno
import fcntl
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import BashComplete

from bcre_studies import cli
from bcre_studies.advisor import advice_text
from bcre_studies.system import files
from bcre_studies.system.files import alone, replace_bytes, sweep
from bcre_studies.system.release import release

CA = ("--model", "ca", "--frames", "2")


def summary(folder):
    return json.loads(Path(folder, "summary.json").read_text(encoding="utf-8"))


# Inputs


@pytest.mark.parametrize("name", ["profiles.csv", "summary.json"])
def test_run_never_overwrites_its_own_table(bcre, scene, name):
    path = scene(table_name=name)
    before = Path(name).read_bytes()
    told = bcre("run", path, *CA, "--out", ".").refusal
    assert told.startswith(f"--out = '{name}': would overwrite what it is made from")
    assert Path(name).read_bytes() == before


def test_run_never_overwrites_its_own_table_through_a_link(bcre, scene):
    path = scene("data")
    Path("o").mkdir()
    Path("o/profiles.csv").symlink_to("../data/ground.csv")
    before = Path("data/ground.csv").read_bytes()
    assert "would overwrite" in bcre("run", path, *CA, "--out", "o").refusal
    assert Path("data/ground.csv").read_bytes() == before


def test_run_never_overwrites_its_own_scene(bcre, scene):
    path = scene(name="summary.json")
    assert "'summary.json': would overwrite" in bcre("run", path, *CA, "--out", ".").refusal


@pytest.mark.parametrize("out", ["scene.toml", "ground.csv", "./../{}/scene.toml"])
def test_advice_never_overwrites_the_scene_that_it_was_asked_for(bcre, scene, out):
    path = scene()
    before = path.read_bytes()
    out = out.format(Path.cwd().name)
    assert "would overwrite what it is made from" in bcre("advise", path, "--out", out).refusal
    assert path.read_bytes() == before


# Two scenes of one name


def test_two_scenes_of_one_name_share_a_folder_only_where_asked(bcre, scene):
    one, other = scene("a"), scene("b")
    assert bcre("run", one, *CA).code == 0
    before = Path("out/scene/profiles.csv").read_bytes()
    told = bcre("run", other, *CA).refusal
    assert "out/scene/summary.json is of another scene, ../../a/scene.toml" in told
    assert Path("out/scene/profiles.csv").read_bytes() == before
    assert bcre("run", one, *CA, "--set", "v=0.4").code == 0
    assert Path("out/scene/profiles.csv").read_bytes() != before
    assert bcre("run", other, *CA, "--out", "out/scene").code == 0
    assert summary("out/scene")["ca"]["scene"] == "../../b/scene.toml"


def test_scene_called_like_a_built_in_one_has_no_part_of_its_folder(bcre, scene):
    assert bcre("run", "figure2", *CA, "--set", "until=1").code == 0
    assert "another scene, figure2" in bcre("run", scene(name="figure2.toml"), *CA).refusal


def test_two_scenes_of_one_name_share_no_advice(bcre, scene, monkeypatch):
    monkeypatch.setattr(advice_text, "advise_with_reference", None)  # it must be refused before
    one, other = scene("a"), scene("b")
    Path("out").mkdir()
    Path("out/scene-advice.toml").write_text("# 50 cells\n# advised for ../a/scene.toml\n")
    assert "another scene, ../a/scene.toml" in bcre("advise", other).refusal
    assert advice_text.advised_of(Path("out/scene-advice.toml")) == ["../a/scene.toml"]
    assert one.is_file()


# The summary


def test_summary_says_what_was_run(bcre, scene):
    noise = '[[surface]]\nkind = "noise"\namplitude = 0.0\nseed = 41\n'
    path = scene("a")
    path.write_text(path.read_text() + noise)
    changes = ("--set", "v=0.4", "--set", "rolling.0.width=1.5")
    assert bcre("run", path, *CA, *changes, "--out", "results/o").code == 0
    told = summary("results/o")["ca"]
    assert told["scene"] == "../../a/scene.toml"
    assert told["title"] == "A pulse on a table"
    assert told["changes"] == ["v=0.4", "rolling.0.width=1.5"]
    assert told["version"] == release()
    assert told["seed"] == 41
    assert bcre("run", "figure2", *CA, "--set", "until=1").code == 0
    told = summary("out/figure2")["ca"]
    assert (told["scene"], told["seed"]) == ("figure2", None)


# Files


@pytest.mark.parametrize("umask", [0o002, 0o022, 0o077])
def test_new_file_has_the_modes_of_the_umask(tmp_path, umask):
    before = os.umask(umask)
    try:
        replace_bytes(tmp_path / "a", b"new")
        (tmp_path / "b").write_bytes(b"new")
    finally:
        os.umask(before)
    modes = [(tmp_path / name).stat().st_mode & 0o777 for name in "ab"]
    assert modes == [0o666 & ~umask] * 2


def test_file_that_is_there_keeps_its_modes(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    path.chmod(0o640)
    replace_bytes(path, b"new")
    assert (path.read_bytes(), path.stat().st_mode & 0o777) == (b"new", 0o640)


@pytest.mark.parametrize("there", [True, False])
def test_link_is_written_through(tmp_path, there):
    (tmp_path / "far").mkdir()
    if there:
        (tmp_path / "far/real").write_bytes(b"old")
    (tmp_path / "link").symlink_to("far/real")
    replace_bytes(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "far/real").read_bytes() == b"new"
    assert [path.name for path in (tmp_path / "far").iterdir()] == ["real"]


def test_links_in_a_circle_are_refused_by_name(tmp_path):
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    with pytest.raises(OSError, match=r"a: cannot be written: "):
        replace_bytes(tmp_path / "a", b"new")


@pytest.mark.parametrize("code", sorted(files.LOCKLESS))
def test_file_system_without_locks_is_written_to(tmp_path, monkeypatch, code):
    def refuse(*_):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(fcntl, "flock", refuse)
    (tmp_path / ".a.1.part").write_bytes(b"half")  # of a writer that may live
    replace_bytes(tmp_path / "a", b"new")
    assert (tmp_path / "a").read_bytes() == b"new"
    sweep(tmp_path, "*")
    with alone(tmp_path / "lock", "waits"):
        pass
    assert {path.name for path in tmp_path.iterdir()} == {"a", ".a.1.part", "lock"}


def test_disk_that_fails_while_a_file_is_locked_is_reported(tmp_path, monkeypatch):
    def fail(*_):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(fcntl, "flock", fail)
    with pytest.raises(OSError, match="a: cannot be written: Input/output error"):
        replace_bytes(tmp_path / "a", b"new")


# The terminal


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "utf-8"])
def test_name_that_the_terminal_cannot_show_is_escaped_and_the_run_succeeds(
    bcre, scene, monkeypatch, encoding
):
    path = scene("Ωmega", name="\udcff.toml")
    out = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "argv", ["bcre", "run", str(path), *CA, "--out", "Ω\udcff"])
    cli.main()
    out.flush()
    told = out.buffer.getvalue()
    assert b"\\udcff" in told
    assert ("Ω".encode() if encoding == "utf-8" else b"\\u03a9") in told
    assert summary("Ω\udcff")["ca"]["cells"] == 20


def test_reader_that_has_seen_enough_is_no_failed_claim():
    script = "from bcre_studies.cli import main; main()"
    command = [sys.executable, "-c", script, "list"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as listing:
        listing.stdout.close()
        told = listing.stderr.read()
    assert (listing.returncode, told) == (cli.BROKEN_PIPE, b"")


def test_bars_go_to_standard_error(capsys, monkeypatch):
    from bcre_studies.sweeps import parallel

    monkeypatch.setenv("LOKY_MAX_CPU_COUNT", "1")
    parallel.each(hex, range(3), "some cases")
    told = capsys.readouterr()
    assert "some cases" in told.err
    assert told.out == ""


def test_a_quiet_run_shows_no_bars_on_a_terminal_and_says_its_refusal(
    tmp_path, monkeypatch, capsys
):
    seen = []

    def run(*_):
        seen.append(sys.stderr.isatty())
        raise ValueError("v = -1: must be >= 0")

    monkeypatch.setattr("bcre_studies.on_line.command.run", run)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    for quiet in ([], ["--quiet"]):
        monkeypatch.setattr(sys, "argv", ["bcre", "run", "figure2", *quiet])
        with pytest.raises(SystemExit):
            cli.main()
        assert capsys.readouterr().err == "bcre: v = -1: must be >= 0\n"
    assert seen == [True, False]


def test_version_is_that_of_the_package(bcre):
    assert bcre("--version") == (0, f"bcre {release()}\n", "")


def test_module_is_the_command():
    ended = subprocess.run(
        [sys.executable, "-m", "bcre_studies", "--version"], capture_output=True, text=True
    )
    assert (ended.returncode, ended.stdout) == (0, f"bcre {release()}\n")


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("run figure1_b", "figure1_between"),
        ("show rough", "rough_slope"),
        ("study second", "second_critical_angle"),
        ("sh", "show"),
        ("run figure2 --mod", "--model"),
    ],
)
def test_shell_completes_what_is_typed(typed, offered):
    *before, last = typed.split()
    completion = BashComplete(cli.app, {}, "bcre", "_BCRE_COMPLETE")
    assert offered in [item.value for item in completion.get_completions(before, last)]


def test_shell_is_answered_under_the_name_of_the_command():
    script = "from bcre_studies.cli import main; main()"
    environment = os.environ | {"_BCRE_COMPLETE": "bash_source"}
    command = [sys.executable, "-c", script]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert "complete -o nosort -F _bcre_completion bcre" in ended.stdout


@pytest.mark.parametrize("command", [[], *([name] for name in cli.app.commands)])
def test_every_help_has_an_example_that_begins_with_the_command(bcre, command):
    ended = bcre(*command, "--help")
    assert ended.code == 0
    examples = ended.out.partition("Examples:\n")[2].split("\n\n")[0].splitlines()
    assert examples
    for line in examples:
        assert line.split()[: 1 + len(command)] == ["bcre", *command]
