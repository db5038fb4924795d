"""``python -m manutec_r3`` is the command ``manutec-r3``."""

from .command_line import main

main()
