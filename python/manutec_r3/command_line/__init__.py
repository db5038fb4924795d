"""The command `manutec-r3`: it runs scenarios, shows, compares and draws what came out.

The commands are in `running`, `judging` and `drawing`; `app` has what they share.
"""

# In the order in which help lists their commands.
from . import running  # isort: split

from . import drawing  # isort: split

from . import judging  # isort: split

from .app import app

__all__ = ["app", "drawing", "judging", "main", "running"]


def main() -> None:
    """Run the command line."""
    app()
