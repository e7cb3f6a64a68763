"""``python -m bcre_studies`` is the command ``bcre``."""

from bcre_studies.cli import main

main()
