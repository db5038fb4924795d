"""All tables of the README about speed, measured again: `python tests/benchmarks`.

The picture there is drawn by `notebooks/draw_pictures.py`.
"""

import subprocess
import sys

import instructions

if __name__ == "__main__":
    bench = subprocess.run([sys.executable, "-m", "manutec_r3", "bench", "--markdown"])
    print(instructions.table())
    sys.exit(bench.returncode)
