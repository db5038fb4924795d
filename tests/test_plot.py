"""Pictures: what is drawn, where exactly an axis is shown to stick, where two results part."""

import sys
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.text import Text

import manutec_r3 as r3
from manutec_r3.plot import comparison, figure9, sticking


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


def test_one_axis_makes_one_row_that_says_what_turns():
    result = r3.Scenario.load("one-axis").run()
    figure, rows = panels(result)
    assert rows.shape == (1, 3)
    heading = "Manutec r3, one axis of the Modelica variant, inertia 19.5 kg m\N{SUPERSCRIPT TWO}"
    assert figure.get_suptitle() == heading
    (shade,) = (c for c in rows[0, 0].collections if isinstance(c, PolyCollection))
    drawn = [path.get_extents().intervalx for path in shade.get_paths()]
    np.testing.assert_allclose(drawn, np.transpose(sticking(result, 1)), rtol=1e-15)
    knots = [m for m in rows[0, 0].lines if m.get_label() == "knot of the reference"]
    np.testing.assert_array_equal([m.get_xdata()[0] for m in knots], result.motion.knots[1:])


def test_the_heading_says_which_model_and_load():
    for robot, heading in (
        (r3.Robot(2), "Manutec r3, model 2, no load"),
        (r3.Robot(4, r3.Load(2.5)), "Manutec r3, model 4, load 2.5 kg"),
        (r3.Robot("full-robot"), "Manutec r3, full robot of the Modelica variant, load 15 kg"),
    ):
        result = r3.simulate(robot, r3.Hold([0.0] * robot.n_axes), t_end=0.01)
        assert figure9(result).get_suptitle() == heading


def test_without_a_motion_there_is_neither_a_reference_nor_an_error():
    robot = r3.Robot(model=3, controller=None)
    result = r3.simulate(robot, None, t_end=0.05, motor_torque=[1.0, 0.2, 0.3, 0.0, 0.0, 0.5])
    figure, rows = panels(result)
    for angle, error, torque in rows:
        assert {line.get_label() for line in angle.lines} == {"simulated"}
        assert not error.lines
        assert [note.get_text() for note in error.texts] == ["no reference"]
        curve(torque, "simulated")
    # axes that nothing moves: a flat line, not a magnified nothing
    assert np.ptp(rows[3, 2].get_ylim()) > 1e-3
    assert_no_words_overlap(figure, rows.flat)


@pytest.mark.parametrize("name", ["figure9", "full-robot", "one-axis"])
def test_no_words_overlap(name):
    figure, rows = panels(r3.Scenario.load(name).run())
    assert_no_words_overlap(figure, rows.flat)


def assert_no_words_overlap(figure, panels):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    # labels of ticks exist also where they are not drawn; Matplotlib keeps them apart itself
    ticks = {t for p in panels for t in (*p.get_xticklabels(), *p.get_yticklabels())}
    words = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text() and t not in ticks]
    boxes = [(t.get_text(), t.get_window_extent(canvas.get_renderer())) for t in words]
    assert len(boxes) > 8  # headings, axes, peaks, legend
    for (one, box), (other, other_box) in combinations(boxes, 2):
        assert not box.overlaps(other_box), (one, other)


def test_the_callers_pyplot_is_left_alone(result, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)  # any import of it fails
    figure9(result).savefig(tmp_path / "figure9.png")
    comparison(r3.compare(result, result)).savefig(tmp_path / "comparison.png")


def test_without_matplotlib_the_error_says_how_to_get_it(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ImportError, match=r'pip install "manutec-r3\[plot\]"'):
        figure9(result)
    with pytest.raises(ImportError, match=r'pip install "manutec-r3\[plot\]"'):
        comparison(r3.compare(result, result))


# --- where two results part ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def compared(result):
    """The same run with a load that is a little lighter."""
    lighter = r3.Robot(model=3, load=r3.Load(mass=14.5))
    return r3.compare(r3.simulate(lighter, result.motion, t_end=1.5), result)


def test_the_worst_curves_are_drawn_with_their_tubes(compared):
    figure = comparison(compared, n=4)
    above, below = np.reshape(figure.axes, (2, 4))
    for panel, difference, worst in zip(above, below, compared.worst(4), strict=True):
        signal = worst.signal.replace("_", " ").capitalize()
        assert panel.get_title(loc="left").startswith(f"{signal} {worst.axis} [")
        time, drawn = curve(panel, "result")
        np.testing.assert_array_equal(time, worst.time)
        np.testing.assert_array_equal(drawn, worst.value)
        time, drawn = curve(panel, "reference")
        np.testing.assert_array_equal(time, worst.reference_time)
        np.testing.assert_array_equal(drawn, worst.reference)
        (tube,) = (c for c in panel.collections if c.get_label() == "tube")
        ends = tube.get_paths()[0].get_extents()
        assert (ends.y0, ends.y1) == (worst.lower.min(), worst.upper.max())
        line = difference.lines[0]
        np.testing.assert_array_equal(line.get_xdata(), worst.difference_time)
        np.testing.assert_array_equal(line.get_ydata(), worst.difference)
        (note,) = difference.texts
        assert f"at {worst.instant:.3f} s" in note.get_text()


def test_the_time_outside_the_tube_is_shaded(compared):
    figure = comparison(compared)
    above, below = np.reshape(figure.axes, (2, 3))
    for column, worst in zip(zip(above, below, strict=True), compared.worst(3), strict=True):
        for panel in column:
            (shade,) = (c for c in panel.collections if c.get_label() == "outside the tube")
            spans = [path.get_extents().intervalx for path in shade.get_paths()]
            begin, end = np.transpose(spans)[:, :, None]
            # A bar is drawn from its beginning and its width, whose sum rounds. At an event one
            # side of an instant may be outside, and the other not.
            near = (begin - 1e-12 <= worst.time) & (worst.time <= end + 1e-12)
            assert near.any(axis=0)[worst.outside].all()
            within = (begin + 1e-12 < worst.time) & (worst.time < end - 1e-12)
            assert worst.outside[within.any(axis=0)].all()


def test_events_that_only_one_has_are_marked(compared):
    different = {e.time for e in (*compared.events.extra, *compared.events.missing)}
    assert different
    for panel in comparison(compared).axes:
        marks = (m for m in panel.lines if m.get_label() == "event that only one has")
        assert {mark.get_xdata()[0] for mark in marks} == different


def test_what_agrees_has_neither_shades_nor_marks(result):
    compared = r3.compare(result, result)
    figure = comparison(compared)
    heading = f"All {len(compared.curves)} curves stay inside the tube, events agree"
    assert figure.get_suptitle() == heading
    labels = {text.get_text() for legend in figure.legends for text in legend.get_texts()}
    assert labels == {"tube", "reference", "result"}


def test_the_heading_of_a_comparison_says_what_was_found(compared, result):
    outside = sum(not curve.agrees for curve in compared.curves)
    heading = f"{outside} of {len(compared.curves)} curves leave the tube, events differ"
    assert comparison(compared).get_suptitle() == heading


@pytest.mark.parametrize("n", [1, 3])
def test_no_words_of_a_comparison_overlap(compared, n):
    figure = comparison(compared, n)
    assert_no_words_overlap(figure, figure.axes)


@pytest.mark.parametrize(("n", "error"), [(0, ValueError), (1.5, TypeError), (True, TypeError)])
def test_a_number_of_curves_that_is_none_is_refused(compared, n, error):
    with pytest.raises(error, match=f"n: expected .* curve.*, got {n}"):
        comparison(compared, n)
