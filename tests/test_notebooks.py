"""The notebooks run from top to bottom, and the pictures of the README can be drawn again."""

import importlib.util
import json
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

every_notebook = pytest.mark.parametrize(
    "path", sorted(NOTEBOOKS.glob("*.ipynb")), ids=lambda path: path.stem
)


def code_cells(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in cells if cell["cell_type"] == "code"]


def as_python(cell):
    """The source of a cell without the lines that only Jupyter understands."""
    return "".join(line for line in cell["source"] if not line.startswith("%"))


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
    """The script beside the notebooks."""
    spec = importlib.util.spec_from_file_location("draw_pictures", NOTEBOOKS / "draw_pictures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@every_notebook
def test_a_notebook_runs_from_top_to_bottom(path, agg):
    names = {}
    for number, cell in enumerate(code_cells(path), start=1):
        exec(compile(as_python(cell), f"{path.name}, code cell {number}", "exec"), names)
    for figure in map(plt.figure, plt.get_fignums()):
        figure.canvas.draw()  # what a cell has built, a reader also sees


@every_notebook
def test_a_notebook_is_kept_without_outputs(path):
    for cell in code_cells(path):
        assert cell["outputs"] == []
        assert cell["execution_count"] is None


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
