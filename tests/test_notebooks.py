"""The notebooks run from top to bottom, and the pictures of the README can be drawn again."""

import importlib.util
import json
import re
import shutil
from itertools import combinations
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"
PICTURES = NOTEBOOKS / "pictures"
# What a notebook needs besides the package.
NEEDED = {"7_other_simulators": ["fmpy", "mujoco"], "8_optimal_motions": ["casadi"]}

every_notebook = pytest.mark.parametrize(
    "path", sorted(NOTEBOOKS.glob("*.ipynb")), ids=lambda path: path.stem
)


def script(name):
    """A script beside the notebooks, as a module."""
    spec = importlib.util.spec_from_file_location(name, NOTEBOOKS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


run_notebooks = script("run_notebooks")


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture
def agg():
    """Draws without a screen, as a notebook does, and leaves no figure behind."""
    before = mpl.get_backend()
    plt.switch_backend("Agg")
    yield
    plt.close("all")
    plt.switch_backend(before)


@pytest.fixture
def draw_pictures():
    return script("draw_pictures")


@every_notebook
def test_a_notebook_prints_what_is_kept_in_it(path, agg):
    for module in NEEDED.get(path.stem, ()):
        pytest.importorskip(
            module, reason=f"{module} is missing: pip install 'manutec-r3[notebooks]'"
        )
    for cell, outputs in run_notebooks.run(read(path), path.name):
        assert cell["outputs"] == outputs


@every_notebook
def test_a_notebook_is_kept_without_pictures(path):
    assert path.stat().st_size < 30_000
    for cell in run_notebooks.code_cells(read(path)):
        assert cell["execution_count"] is None
        assert [output["output_type"] for output in cell["outputs"]] in ([], ["stream"])


@every_notebook
def test_a_notebook_ends_with_what_to_try(path):
    last = read(path)["cells"][-1]
    headings = [line.strip() for line in last["source"] if line.startswith("#")]
    assert headings[-1:] == ["## What to try"]


@every_notebook
def test_links_of_a_notebook_lead_to_files_that_exist(path):
    for cell in read(path)["cells"]:
        for link in re.findall(r"\]\(([^)]+)\)", "".join(cell["source"])):
            assert cell["cell_type"] == "code" or (NOTEBOOKS / link).exists(), link


def test_the_script_draws_every_picture_that_is_kept(draw_pictures, tmp_path):
    draw_pictures.main(tmp_path, repeats=1)
    drawn = {path.name for path in tmp_path.iterdir()}
    kept = {path.name for path in PICTURES.iterdir()}
    assert drawn == (kept if shutil.which("chromium") else kept - {"animation.png"})


def test_no_words_overlap_in_the_blocks(draw_pictures):
    figure = draw_pictures.blocks()
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    words = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    boxes = [(text.get_text(), text.get_window_extent(canvas.get_renderer())) for text in words]
    assert len(boxes) > 20
    for (one, box), (other, other_box) in combinations(boxes, 2):
        assert not box.overlaps(other_box), (one, other)
