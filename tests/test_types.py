"""mypy finds nothing wrong in the package, in the code of the notebooks, and in `typed_lines`."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy", reason="mypy is missing: pip install 'manutec-r3[test]'")

ROOT = Path(__file__).parents[1]


def code(notebook):
    """The code of a notebook as one program, without lines that only Jupyter understands."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    sources = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
    of_python = (filter(lambda line: not line.startswith("%"), source) for source in sources)
    return "\n".join(map("".join, of_python))


def test_mypy_finds_nothing_wrong(tmp_path):
    copies = tmp_path / "notebooks"  # a package of this name has settings of its own
    copies.mkdir()
    (copies / "__init__.py").touch()
    for notebook in (ROOT / "notebooks").glob("*.ipynb"):
        (copies / f"{notebook.stem}.py").write_text(code(notebook), encoding="utf-8")
    for script in (ROOT / "notebooks").glob("*.py"):
        shutil.copy(script, copies)
    command = [sys.executable, "-m", "mypy", "--cache-dir", os.devnull, "--no-error-summary"]
    read = [ROOT / "python" / "manutec_r3", ROOT / "tests" / "typed_lines.py", copies]
    found = subprocess.run([*command, *read], cwd=ROOT, capture_output=True, text=True)
    assert found.stdout + found.stderr == ""
    assert found.returncode == 0
