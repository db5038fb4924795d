"""All that the README says about speed, measured again: `python tests/benchmarks`.

Prints the tables of its section Speed. The picture there is drawn by `notebooks/draw_pictures.py`.
"""

import instructions

from manutec_r3.command_line import app

if __name__ == "__main__":
    print(instructions.table(), end="\n\n", flush=True)
    app(["bench", "--markdown"])
