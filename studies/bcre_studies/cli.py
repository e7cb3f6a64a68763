"""The command ``bcre``. Heavy modules are imported when a command needs them."""

from __future__ import annotations

import os
import signal
import sys
import threading
from typing import Any

import click

from bcre_studies.commands.advise import advise
from bcre_studies.commands.check import check
from bcre_studies.commands.listing import list_all
from bcre_studies.commands.new import new
from bcre_studies.commands.options import examples
from bcre_studies.commands.play import play
from bcre_studies.commands.report import report
from bcre_studies.commands.run import run
from bcre_studies.commands.show import show
from bcre_studies.commands.speed import speed
from bcre_studies.commands.study import run_studies
from bcre_studies.commands.sweep import sweep
from bcre_studies.system.one_line import one_line
from bcre_studies.system.release import release

COMMANDS = (run, play, new, show, advise, sweep, list_all, run_studies, report, check, speed)

BROKEN_PIPE = 141
"""The exit code of a program whose reader has gone, as a shell gives it."""


class _Commands(click.Group):
    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; a reader that has gone, as in ``bcre list | head -1``, ends it."""
        try:
            result = super().invoke(ctx)
            sys.stdout.flush()
        except BrokenPipeError:  # which click takes for a failure of exit code 1
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(BROKEN_PIPE)
        return result


@click.group(
    cls=_Commands,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog=examples("bcre list", "bcre run figure2", "bcre run --help")
    + "\n\n\b\nTab completion, a line for the shell's start-up file (bash; zsh and fish alike):\n"
    + '  eval "$(_BCRE_COMPLETE=bash_source bcre)"',
)
@click.version_option(release(), prog_name="bcre", message="%(prog)s %(version)s")
def app() -> None:
    """Does a two-layer cellular automaton of sandpiles do what the BCRE equations do?"""


for command in COMMANDS:
    app.add_command(command)


def main() -> None:
    """Run the command; bad input ends in one line on standard error and exit 2."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends the workers too
    _show_every_name()
    try:
        app(prog_name="bcre", standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
    except click.ClickException as error:
        _refuse(error.format_message())
    except (click.Abort, KeyboardInterrupt):
        click.echo("bcre: interrupted; every file written before is whole", err=True)
        sys.exit(130)
    except (ValueError, OSError, ArithmeticError) as error:
        _refuse(str(error))
    except MemoryError as error:
        _refuse(f"not enough memory: {error}")


def _show_every_name() -> None:
    """Let a terminal show what it can of a title or a path, and escapes for the rest."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def _refuse(message: str) -> None:
    click.echo(f"bcre: {one_line(message)}", err=True)
    sys.exit(2)
