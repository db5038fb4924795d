"""Instructions of one evaluation, counted by Valgrind: the same on busy machines as on quiet ones.

    python tests/benchmarks/instructions.py

Builds `right_hand_side.cpp` with the cores that Python gets, for the baseline processor and for
x86-64-v3. One evaluation takes the difference of two runs, one of which evaluates the same case
more often.
"""

import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

SOURCE = Path(__file__).parents[2]
FEW, MANY = 64, 1088  # evaluations: whole rounds through the 64 states that the program sees
PREFIX = "right_hand_side_"  # of programs; the rest says for which processor


def output(*command):
    """Run a command; what it says, or an error with all of it."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stdout}")
    return done.stdout


def build(folder):
    """The programs, by processor."""
    options = {
        "CMAKE_BUILD_TYPE": "Release",
        "MANUTEC_R3_PYTHON": "OFF",
        "MANUTEC_R3_BENCHMARKS": "ON",
        "Python_EXECUTABLE": sys.executable,
    }
    defined = (f"-D{name}={value}" for name, value in options.items())
    output("cmake", "-S", SOURCE, "-B", folder, *defined)
    output("cmake", "--build", folder, "--target", "right_hand_sides", "--parallel", "2")
    programs = sorted((Path(folder) / "tests" / "benchmarks").glob(f"{PREFIX}*"))
    return {program.name.removeprefix(PREFIX): program for program in programs}


def names(program):
    """All cases: the program lists them when it is asked for one that it does not have."""
    usage = subprocess.run([program, "?", "1"], capture_output=True, text=True).stderr
    return usage.partition("one of ")[2].split()


def collected(program, name, count):
    """Instructions of a run that evaluates one case so many times."""
    said = output(
        *("valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"),
        *(program, name, str(count)),
    )
    return int(re.search(r"Collected : (\d+)", said)[1])


def table():
    """The counts as Markdown."""
    counts = {}
    with TemporaryDirectory() as folder:
        programs = build(folder)
        for processor, program in programs.items():
            for name in names(program):
                more = collected(program, name, MANY) - collected(program, name, FEW)
                counts.setdefault(name, {})[processor] = round(more / (MANY - FEW))
    lines = [
        ("instructions", *programs),
        ("---", *("---:" for _ in programs)),
        *((name.replace("_", " "), *map(str, row.values())) for name, row in counts.items()),
    ]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


if __name__ == "__main__":
    print(table())
