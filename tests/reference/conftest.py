"""The plain integrations stand beside their tests, which find them by this folder."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
