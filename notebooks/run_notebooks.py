"""Runs the notebooks and keeps what they print: `python notebooks/run_notebooks.py`.

What a cell prints is kept in its notebook, as far as it is the same on every machine: a cell with
the tag `nbval-ignore-output` says otherwise. Pictures and tables are not kept; they are made anew
when a reader runs the notebook, and would weigh a hundred times as much.
"""

import json
from collections.abc import Iterator
from contextlib import chdir, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt

FOLDER = Path(__file__).resolve().parent
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
VARIES = "nbval-ignore-output"  # what the tool nbval calls it


def code_cells(notebook: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the cells of a notebook that have code."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def run(notebook: dict[str, Any], name: str) -> Iterator[tuple[dict[str, Any], list]]:
    """Run a notebook from top to bottom, and yield each cell with the outputs to keep.

    Every picture of a cell is drawn, as a reader would see it, and forgotten before the next cell.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    with chdir(FOLDER), mpl.rc_context():
        for number, cell in enumerate(code_cells(notebook), start=1):
            said = StringIO()
            with redirect_stdout(said):
                exec(compile("".join(cell["source"]), f"{name}, code cell {number}", "exec"), names)
            for figure in map(plt.figure, plt.get_fignums()):
                figure.canvas.draw()
            plt.close("all")
            lines = said.getvalue().splitlines(keepends=True)
            is_kept = lines and VARIES not in cell["metadata"].get("tags", ())
            yield cell, [{"name": "stdout", "output_type": "stream", "text": lines}] * bool(is_kept)


def main() -> None:
    """Run all notebooks and write what they print into them."""
    plt.switch_backend("Agg")
    for path in NOTEBOOKS:
        notebook = json.loads(path.read_text(encoding="utf-8"))
        for cell, outputs in run(notebook, path.name):
            cell["outputs"] = outputs
        text = json.dumps(notebook, indent=1, ensure_ascii=False)
        path.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
