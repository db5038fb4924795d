"""The picture of Figure 9: what is drawn, and where exactly an axis is shown to stick."""

import sys
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.text import Text

import manutec_r3 as r3
from manutec_r3.plot import figure9, sticking


@pytest.fixture(scope="module")
def result():
    return r3.Scenario.load("figure9").run()


def panels(result):
    """Figure and its panels, (n_axes, 3)."""
    figure = figure9(result)
    return figure, np.reshape(figure.axes, (result.robot.n_axes, 3))


def curve(panel, label):
    (line,) = (line for line in panel.lines if line.get_label() == label)
    return line.get_xdata(), line.get_ydata()


def test_each_axis_has_its_angle_error_and_torque(result):
    _, rows = panels(result)
    for i, (angle, error, torque) in enumerate(rows):
        for panel, label, values in (
            (angle, "simulated", result.joint_angle),
            (angle, "reference", result.reference_angle),
            (error, "simulated", 1e3 * result.control_error),  # drawn in mrad
            (torque, "simulated", result.motor_torque),
        ):
            time, drawn = curve(panel, label)
            np.testing.assert_array_equal(time, result.time)
            np.testing.assert_array_equal(drawn, values[:, i])


def test_an_axis_sticks_exactly_between_its_friction_events(result):
    for axis in range(1, 7):
        friction = [e for e in result.events if (e.axis, e.element) == (axis, "friction")]
        assert friction[0].before == 0  # at rest in the beginning
        begin = [0.0] + [e.time for e in friction if e.after == 0]
        end = [e.time for e in friction if e.before == 0]
        if friction[-1].after == 0:
            end.append(1.5)
        np.testing.assert_array_equal(sticking(result, axis), (begin, end))


def test_the_shading_is_where_the_axis_sticks(result):
    _, rows = panels(result)
    for axis, row in enumerate(rows, start=1):
        for panel in row:
            (shade,) = (c for c in panel.collections if isinstance(c, PolyCollection))
            drawn = [path.get_extents().intervalx for path in shade.get_paths()]
            # a bar is drawn from its beginning and its width, whose sum rounds
            np.testing.assert_allclose(drawn, np.transpose(sticking(result, axis)), rtol=1e-15)


def test_ideal_gears_never_stick():
    result = r3.simulate(r3.Robot(model=2), r3.Hold([0.0] * 3), t_end=0.01)
    assert np.size(sticking(result, 1)) == 0


def test_three_axes_make_three_rows():
    result = r3.simulate(r3.Robot(model=4), r3.Hold([0.1, 0.2, 0.3]), t_end=0.01)
    _, rows = panels(result)
    assert [row[0].get_ylabel() for row in rows] == ["axis 1", "axis 2", "axis 3"]


def test_no_words_overlap(result):
    figure, rows = panels(result)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    # labels of ticks exist also where they are not drawn; Matplotlib keeps them apart itself
    ticks = {t for p in rows.flat for t in (*p.get_xticklabels(), *p.get_yticklabels())}
    words = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text() and t not in ticks]
    boxes = [(t.get_text(), t.get_window_extent(canvas.get_renderer())) for t in words]
    assert len(boxes) > 20  # headings, axes, peaks, legend
    for (one, box), (other, other_box) in combinations(boxes, 2):
        assert not box.overlaps(other_box), (one, other)


def test_the_callers_pyplot_is_left_alone(result, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)  # any import of it fails
    figure9(result).savefig(tmp_path / "figure9.png")


def test_without_matplotlib_the_error_says_how_to_get_it(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ImportError, match=r'pip install "manutec-r3\[plot\]"'):
        figure9(result)
