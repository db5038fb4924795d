"""The command `manutec-r3`: runs scenarios, shows, compares, draws and exports.

The commands are in `running`, `drawing`, `judging` and `exporting`; `app` has what they share.
"""

# In the order in which help lists their commands.
from . import running  # isort: split

from . import drawing  # isort: split

from . import judging  # isort: split

from . import exporting  # isort: split

from .app import app

__all__ = ["app", "drawing", "exporting", "judging", "main", "running"]


def main() -> None:
    """Run the command line."""
    app()
