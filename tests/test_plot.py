"""Pictures: what is drawn where, in which units, and that it can be read."""

import subprocess
import sys
from itertools import combinations

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.text import Text

import manutec_r3 as r3
from manutec_r3.plot import comparison, figure9, new_figure, sticking


@pytest.fixture(autouse=True)
def pyplot():
    """Draws without a screen, and leaves no figure behind."""
    before = plt.get_backend()
    plt.switch_backend("Agg")
    yield
    plt.close("all")
    plt.switch_backend(before)


@pytest.fixture(scope="module")
def result():
    return r3.Scenario.load("figure9-quintic").run()


@pytest.fixture(scope="module")
def variant():
    return r3.Scenario.load("full-robot").run()


@pytest.fixture(scope="module")
def one_axis():
    return r3.Scenario.load("one-axis").run()


@pytest.fixture(scope="module")
def without_motion():
    robot = r3.Robot(model=3, controller=None)
    return r3.simulate(robot, None, t_end=0.05, motor_torque=[1.0, 0.2, 0.3, 0.0, 0.0, 0.5])


@pytest.fixture(scope="module")
def runs(result, variant, one_axis, without_motion):
    """Runs of all kinds: with and without gears, motions, events and samples."""
    hold = r3.Hold([0.3, -0.5, 0.8, 0.2, 0.4, 0.0])
    ideal = r3.Robot(model=1, load=r3.Load(5.0))
    sampled = result.robot.replace(controller="sampled")
    return {
        "figure9": result,
        "full-robot": variant,
        "one-axis": one_axis,
        "without a motion": without_motion,
        "without events": r3.simulate(result.robot, hold, t_end=0.1),
        "ideal gears": r3.simulate(ideal, result.motion, t_end=1.5),
        "three axes": r3.simulate(r3.Robot(model=4), r3.Hold([0.1, 0.2, 0.3]), t_end=0.1),
        "ideal gears, three axes": r3.simulate(r3.Robot(model=2), r3.Hold([0.0] * 3), t_end=0.1),
        "sampled": r3.simulate(sampled, result.motion, t_end=1.5, list_samples=True),
        "nothing switches": r3.simulate(r3.Robot(model=1, controller=None), None, t_end=0.1),
    }


def panels(result):
    """Figure and its panels, (n_axes, 3)."""
    rows = figure9(result)
    assert rows.shape == (result.robot.n_axes, 3)
    return rows[0, 0].figure, rows


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


def test_one_axis_makes_one_row_that_says_what_turns(one_axis):
    result = one_axis
    figure, rows = panels(result)
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
        assert panels(result)[0].get_suptitle() == heading


def test_without_a_motion_there_is_neither_a_reference_nor_an_error(without_motion):
    figure, rows = panels(without_motion)
    for angle, error, torque in rows:
        assert {line.get_label() for line in angle.lines} == {"simulated"}
        assert not error.lines
        assert [note.get_text() for note in error.texts] == ["no reference"]
        curve(torque, "simulated")
    # axes that nothing moves: a flat line, not a magnified nothing
    assert np.ptp(rows[3, 2].get_ylim()) > 1e-3
    assert_no_words_overlap(figure, rows.flat)


@pytest.mark.parametrize("name", ["figure9", "full-robot", "one-axis"])
def test_no_words_of_figure_9_overlap(runs, name):
    figure, rows = panels(runs[name])
    assert_no_words_overlap(figure, rows.flat)


def assert_no_words_overlap(figure, panels, least=9):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    # labels of ticks exist also where they are not drawn; Matplotlib keeps them apart itself
    ticks = {t for p in panels for t in (*p.get_xticklabels(), *p.get_yticklabels())}
    words = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text() and t not in ticks]
    boxes = [(t.get_text(), t.get_window_extent(canvas.get_renderer())) for t in words]
    assert len(boxes) >= least  # headings, axes, peaks, legend
    for (one, box), (other, other_box) in combinations(boxes, 2):
        assert not box.overlaps(other_box), (one, other)


# --- where two results part ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def compared(result):
    """The same run with a load that is a little lighter."""
    lighter = r3.Robot(model=3, load=r3.Load(mass=14.5))
    return r3.compare(r3.simulate(lighter, result.motion, t_end=1.5), result)


def test_the_worst_curves_are_drawn_with_their_tubes(compared):
    above, below = comparison(compared, n=4)
    for panel, difference, worst in zip(above, below, compared.worst(4), strict=True):
        signal = worst.signal.replace("_", " ").capitalize()
        assert panel.get_title(loc="left").startswith(f"{signal} {worst.axis} [")
        assert difference.get_ylabel().startswith("difference [")
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
    above, below = comparison(compared)
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
    for panel in comparison(compared).flat:
        marks = (m for m in panel.lines if m.get_label() == "event that only one has")
        assert {mark.get_xdata()[0] for mark in marks} == different


def test_what_agrees_has_neither_shades_nor_marks(result):
    compared = r3.compare(result, result)
    heading = f"All {len(compared.curves)} curves stay inside the tube, events agree"
    figure = comparison(compared)[0, 0].figure
    assert figure.get_suptitle() == heading
    labels = {text.get_text() for legend in figure.legends for text in legend.get_texts()}
    assert labels == {"tube", "reference", "result"}


def test_the_heading_of_a_comparison_says_what_was_found(compared, result):
    outside = sum(not curve.agrees for curve in compared.curves)
    heading = f"{outside} of {len(compared.curves)} curves leave the tube, events differ"
    assert comparison(compared)[0, 0].figure.get_suptitle() == heading


@pytest.mark.parametrize("n", [1, 3])
def test_no_words_of_a_comparison_overlap(compared, n):
    drawn = comparison(compared, n)
    assert_no_words_overlap(drawn[0, 0].figure, drawn.flat)


@pytest.mark.parametrize(("n", "error"), [(0, ValueError), (1.5, TypeError), (True, TypeError)])
def test_a_number_of_curves_that_is_none_is_refused(compared, n, error):
    with pytest.raises(error, match=f"n: expected .* curve.*, got {n}"):
        comparison(compared, n)


# --- which branch when --------------------------------------------------------------------------


def rows_of(panel):
    """Place of each row of a timeline by axis and element."""
    groups = {
        note.xy[1]: 0 if note.get_text() == "robot" else int(note.get_text().split()[1])
        for note in panel.texts
    }
    axis, rows = None, {}
    for place, text in zip(panel.get_yticks(), panel.get_yticklabels(), strict=True):
        axis = groups.get(place, axis)
        rows[axis, text.get_text().replace(" ", "_")] = place
    return rows


def bars_of(panel, place):
    """Bars of a row as (begin, end, branch), in the order of time."""
    bars = []
    for collection in panel.collections:
        for path in collection.get_paths():
            box = path.get_extents()
            if abs(0.5 * (box.y0 + box.y1) - place) < 0.5:
                assert collection.get_label()[-1] != "_"
                branch = {"+": 1, "0": 0, "\N{MINUS SIGN}": -1}[collection.get_label()[0]]
                assert np.sign(np.round(box.y0 + box.y1 - 2 * place, 9)) == branch  # above, below
                bars.append((box.x0, box.x1, branch))
    return sorted(bars)


@pytest.mark.parametrize("name", ["figure9", "full-robot", "sampled", "without events"])
def test_bars_begin_and_end_at_the_events_of_their_element(runs, name):
    result = runs[name]
    panel = result.plot_events()
    rows = rows_of(panel)
    switches = [e for e in result.events if e.element not in ("reference", "sample")]
    assert {(e.axis, e.element) for e in switches} <= set(rows)
    for (axis, element), place in rows.items():
        if element == "sample":
            continue
        begin, end, branch = np.transpose(bars_of(panel, place))
        own = [e for e in switches if (e.axis, e.element) == (axis, element)]
        # a bar is drawn from its beginning and its width, whose sum rounds
        ends = [e.time for e in own] + [result.t_end]
        np.testing.assert_allclose(begin, [0.0, *ends[:-1]], rtol=1e-15)
        np.testing.assert_allclose(end, ends, rtol=1e-15)
        np.testing.assert_array_equal(branch[1:], [e.after for e in own])
        assert branch[0] == result.branches[element][0, axis - 1]


def test_rows_are_the_elements_that_an_axis_has(runs):
    electrical = {"dead_zone", "torque_limit"}
    for name, of_axis in {
        "figure9": [
            {*electrical, "friction"} | ({"backlash"} if i < 2 else set()) for i in range(6)
        ],
        "full-robot": [{"friction"}] * 6,
        "ideal gears, three axes": [electrical] * 3,
        "one-axis": [{"friction"}],
    }.items():
        expected = {(i, e) for i, elements in enumerate(of_axis, start=1) for e in elements}
        assert set(rows_of(runs[name].plot_events())) == expected


def test_samples_have_a_row_of_the_whole_robot(runs):
    panel = runs["sampled"].plot_events()
    bars = bars_of(panel, rows_of(panel)[0, "sample"])
    samples = [e.time for e in runs["sampled"].events if e.element == "sample"]
    assert [begin for begin, _, _ in bars] == samples


def test_excesses_of_limits_have_a_row_if_they_are_listed(result):
    fast = r3.Quintic(result.motion.start, result.motion.end, 0.8)
    listing = r3.simulate(result.robot, fast, t_end=0.8, list_limits=True)
    panel = listing.plot_events()
    rows = rows_of(panel)
    for axis in {excess.axis for excess in listing.limits}:
        own = sorted((e.begin, e.end, e.side) for e in listing.limits if e.axis == axis)
        np.testing.assert_allclose(bars_of(panel, rows[axis, "limit"]), own, rtol=1e-15)


def test_where_nothing_switches_the_timeline_says_so(runs):
    panel = runs["nothing switches"].plot_events()
    assert panel.get_title(loc="right") == "no element switches"
    assert runs["without events"].plot_events().get_title(loc="right") == "0 events"
    assert runs["figure9"].plot_events().get_title(loc="right") == "60 events"


# --- friction -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["figure9", "full-robot", "one-axis", "three axes"])
def test_friction_lies_on_the_characteristic_or_sticks(runs, name):
    result = runs[name]
    for axis in range(1, result.robot.n_axes + 1):
        panel = result.plot_friction(axis)
        rate, torque = curve(panel, "simulated")
        np.testing.assert_array_equal(rate, result.rotor_rate[:, axis - 1])
        np.testing.assert_array_equal(torque, result.friction_torque[:, axis - 1])
        rates, torques = curve(panel, "characteristic")
        sliding = rate != 0.0
        half = len(rates) // 2 + 1  # the branch of positive rates without the sticking limit
        held = np.interp(np.abs(rate), rates[half:], torques[half:])
        # both are linear interpolations of the same table: roundoff of torques below 2 N m
        np.testing.assert_allclose(np.abs(torque[sliding]), held[sliding], atol=1e-14)
        assert np.abs(torque[~sliding]).max(initial=0.0) <= torques[half - 1] + 1e-12
        np.testing.assert_array_equal(rates, -rates[::-1])
        np.testing.assert_array_equal(torques, -torques[::-1])


def test_the_characteristic_has_the_corners_of_table_2_and_reaches_beyond_the_run(result):
    table = result.robot.parameters["table_2"]
    for axis in range(1, 7):
        rates, torques = curve(result.plot_friction(axis), "characteristic")
        assert rates[-1] > np.abs(result.rotor_rate[:, axis - 1]).max()
        drawn = set(zip(rates, torques, strict=True))
        points = [point for point in table["friction"][axis - 1] if point[0] < rates[-1]]
        assert {(0.0, table["rM_h"][axis - 1]), *points} <= drawn


def test_an_axis_breaks_away_at_its_sticking_limit(result):
    for axis in range(1, 7):
        panel = result.plot_friction(axis)
        limit = result.robot.parameters["table_2"]["rM_h"][axis - 1]
        rates, torques = curve(panel, "breaks away")
        assert not rates.any()
        # located within roundoff of the time; torques change by less than 1e3 N m/s
        np.testing.assert_allclose(np.abs(torques), limit, rtol=0.0, atol=1e-10)
        begin, end = sticking(result, axis)
        assert len(torques) == np.sum(end < result.t_end)
        assert len(curve(panel, "comes to rest")[1]) == np.sum(begin > 0.0)
        times = "1 time" if len(begin) == 1 else f"{len(begin)} times"
        spent = f"sticks {times}, {np.sum(end - begin):.3f} s in all"
        assert panel.get_title(loc="right") == spent


def test_the_torque_that_holds_is_marked_exactly_while_the_axis_sticks(result):
    _, held = curve(result.plot_friction(3), "sticks")
    sticks = result.branches["friction"][:, 2] == 0
    np.testing.assert_array_equal(held, np.where(sticks, result.friction_torque[:, 2], np.nan))


def test_an_axis_that_never_sticks_has_no_such_marks(without_motion):
    panel = without_motion.plot_friction(6)
    assert panel.get_title(loc="right") == "never sticks"
    assert {"sticks", "comes to rest"}.isdisjoint(panel.get_legend_handles_labels()[1])


# --- backlash -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "axes"), [("figure9", (1, 2, 3)), ("full-robot", (1, 2, 3))])
def test_the_deflection_is_that_of_the_gear(runs, name, axes):
    result = runs[name]
    for axis in axes:
        time, deflection = curve(result.plot_backlash(axis), "simulated")
        gear_ratio = result.robot.parameters["table_1"]["p"][axis - 1]
        expected = result.rotor_angle[:, axis - 1] - gear_ratio * result.joint_angle[:, axis - 1]
        np.testing.assert_array_equal(time, result.time)
        # the difference of two angles of up to 300 rad has lost 1e-13
        np.testing.assert_allclose(deflection, expected, rtol=0.0, atol=1e-12)


def test_teeth_are_apart_where_the_deflection_is_inside_the_gap(result):
    for axis, half_gap in ((1, 0.01), (2, 0.06)):  # Table 2
        panel = result.plot_backlash(axis)
        (gap,) = (patch for patch in panel.patches if patch.get_label() == "gap")
        box = gap.get_extents().transformed(panel.transData.inverted())
        np.testing.assert_allclose((box.y0, box.y1), (-half_gap, half_gap), rtol=1e-12)
        time, deflection = curve(panel, "simulated")
        (apart,) = (c for c in panel.collections if c.get_label() == "no contact")
        begin, end = np.transpose([p.get_extents().intervalx for p in apart.get_paths()])
        # at the ends of an interval the deflection is on the edge, give or take roundoff
        inside = ((begin[:, None] + 1e-9 < time) & (time < end[:, None] - 1e-9)).any(axis=0)
        outside = ((time < begin[:, None] - 1e-9) | (time > end[:, None] + 1e-9)).all(axis=0)
        assert inside.any()
        assert outside.any()
        assert (np.abs(deflection[inside]) < half_gap).all()
        assert (np.abs(deflection[outside]) > half_gap).all()


def test_a_gear_without_a_gap_is_always_in_contact(result, variant):
    for panel in (result.plot_backlash(3), variant.plot_backlash(1)):
        assert panel.get_title(loc="right") == "always in contact"
        labels = set(panel.get_legend_handles_labels()[1])
        assert labels == {"simulated", "knot of the reference"}


# --- phase plane --------------------------------------------------------------------------------


def test_the_phase_plane_has_angle_and_rate_on_the_reference(result):
    panel = result.plot_phase(2)
    for label, x, y in (
        ("simulated", result.joint_angle, result.joint_rate),
        ("reference", result.reference_angle, result.reference_rate),
    ):
        np.testing.assert_array_equal(curve(panel, label), (x[:, 1], y[:, 1]))
    for label, instant in (("start", 0), ("end", -1)):
        ((x,), (y,)) = curve(panel, label)
        assert (x, y) == (result.joint_angle[instant, 1], result.joint_rate[instant, 1])


def test_the_phase_plane_of_the_error_has_its_rate(result):
    error, rate = curve(result.plot_phase(1, of="error"), "simulated")
    np.testing.assert_array_equal(error, 1e3 * result.control_error[:, 0])
    # the error is the integral of its rate; trapezoids of steps this short are good to 1e-3 mrad
    integral = np.concatenate(
        ([0.0], np.cumsum(0.5 * np.diff(result.time) * (rate[1:] + rate[:-1])))
    )
    np.testing.assert_allclose(error - error[0], integral, rtol=0.0, atol=1e-2)


def test_the_rest_of_an_axis_is_a_point_and_no_magnified_roundoff(runs):
    panel = runs["without events"].plot_phase(1)
    for least, most in (panel.get_xlim(), panel.get_ylim()):
        assert most - least > 0.01


def test_without_a_motion_the_phase_plane_has_no_reference(without_motion):
    labels = without_motion.plot_phase(1).get_legend_handles_labels()[1]
    assert labels == ["simulated", "start", "end"]


# --- stroboscope --------------------------------------------------------------------------------


def poses_of(panel):
    return np.array([np.transpose(p.get_data()) for p in panel.lines if p.get_label() == "arm"])


def test_from_the_side_arms_have_their_true_lengths():
    motion = r3.Quintic([0.3, -0.4, 0.2], [1.2, 0.9, 1.1], 1.0)  # axis 1 turns as well
    result = r3.simulate(r3.Robot(model=4, load=r3.Load(15.0)), motion, t_end=1.0)
    poses = poses_of(result.plot_stroboscope(n=5))
    lengths = np.hypot(*np.moveaxis(np.diff(poses, axis=1), -1, 0))
    # foot, shoulder (twice), elbow (twice), wrist (twice), load: specification section 3
    expected = [0.675, 0.0, 0.5, 0.0, 0.73, 0.0, 0.25]
    np.testing.assert_allclose(lengths, np.tile(expected, (5, 1)), rtol=0.0, atol=1e-14)
    # an arm that leans by aq_2 stands to the vertical by that angle, forward
    elbow = poses[:, 3] - poses[:, 2]
    angles = result.at(np.linspace(0.0, 1.0, 5)).joint_angle
    np.testing.assert_allclose(np.arctan2(*elbow.T), angles[:, 1], rtol=0.0, atol=1e-14)


def test_poses_are_taken_at_equal_intervals_and_end_on_the_path(result):
    q = result.at(np.linspace(0.0, 1.5, 7)).joint_angle
    load = result.robot.load_position(q)
    side = poses_of(result.plot_stroboscope(n=7))[:, -1]
    np.testing.assert_array_equal(side[:, 1], load[:, 2] + 0.675)  # above the floor
    panel = result.plot_stroboscope(n=7, view="top")
    np.testing.assert_array_equal(poses_of(panel)[:, -1], load[:, :2])
    x, y = curve(panel, "path of the load")
    assert [(x[k], y[k]) for k in (0, -1)] == [tuple(load[k, :2]) for k in (0, -1)]
    assert panel.get_title(loc="right") == "every 0.25 s"


def test_an_empty_hand_has_a_tip(runs):
    labels = runs["three axes"].plot_stroboscope().get_legend_handles_labels()[1]
    assert "path of the tip" in labels


# --- all pictures -------------------------------------------------------------------------------

PICTURES = {
    "plot_events": {},
    "plot_friction": {"axis": 1},
    "plot_backlash": {"axis": 1},
    "plot_phase": {"axis": 1},
    "plot_stroboscope": {},
}
every_picture = pytest.mark.parametrize("method", PICTURES)


def drawn(run, method):
    """A picture of a run; None if the run has nothing of the kind, which an error says."""
    has_gears, is_arm = run.robot.has_real_gears, run.robot.model != "one-axis"
    possible = {"plot_friction": has_gears, "plot_backlash": has_gears, "plot_stroboscope": is_arm}
    if possible.get(method, True):
        return getattr(run, method)(**PICTURES[method])
    with pytest.raises(ValueError, match=r"expected .*, got (axis 1 of )?model"):
        getattr(run, method)(**PICTURES[method])
    return None


@every_picture
def test_every_run_has_its_picture_with_units_and_no_word_over_another_or_the_data(runs, method):
    for run in runs.values():
        panel = drawn(run, method)
        if panel is None:
            continue
        assert panel.get_xlabel().endswith(("[s]", "[rad]", "[rad/s]", "[m]"))
        if method != "plot_events":
            assert panel.get_ylabel().endswith(("[rad]", "[rad/s]", "[N m]", "[m]"))
        assert_no_words_overlap(panel.figure, [panel], least=3)
        assert panel.get_legend().get_window_extent().y0 >= panel.bbox.y1
        plt.close("all")


@every_picture
def test_a_picture_is_drawn_on_the_axes_that_are_given(result, method):
    own = Figure().subplots()
    assert getattr(result, method)(axes=own) is own
    alone = getattr(result, method)()
    assert [
        np.array_equal(a.get_data(), b.get_data())
        for a, b in zip(own.lines, alone.lines, strict=True)
    ]
    function = getattr(r3.plot, method.removeprefix("plot_"))
    assert isinstance(function(result), type(own))


def test_grids_of_panels_are_drawn_on_the_axes_that_are_given(result, compared):
    for draw, shape in ((result.plot, (6, 3)), (compared.plot, (2, 3))):
        figure = Figure()
        own = figure.subplots(*shape)
        np.testing.assert_array_equal(draw(axes=own.tolist()), own)
        assert figure.legends == []  # the figure is the caller's
        assert figure.get_suptitle() == ""
        with pytest.raises(ValueError, match=r"axes: expected shape \(\d, 3\), .*, got \(1, 3\)"):
            draw(axes=own[:1])


def test_pictures_have_the_widths_of_print(result):
    millimetres = {"plot_events": 170.0, "plot": 170.0}
    for method in ("plot", *PICTURES):
        panel = np.ravel(getattr(result, method)())[0]
        width = 25.4 * panel.figure.get_size_inches()[0]
        assert width == pytest.approx(millimetres.get(method, 85.0))


def test_pyplot_shows_new_figures_and_is_left_alone_by_those_of_the_caller(result, monkeypatch):
    panel = result.plot_phase()
    assert plt.gcf() is panel.figure
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)  # any import of it fails
    for draw in (result.plot, *(getattr(result, method) for method in PICTURES)):
        figure = new_figure()
        assert np.ravel(draw(axes=figure))[0].figure is figure


def test_without_matplotlib_the_error_says_how_to_get_it(result, monkeypatch):
    compared = r3.compare(result, result)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    for draw in (result.plot, compared.plot, *(getattr(result, method) for method in PICTURES)):
        with pytest.raises(ImportError, match=r'pip install "manutec-r3\[plot\]"'):
            draw()


def test_importing_the_package_does_not_import_matplotlib():
    code = "import sys, manutec_r3 as r3; r3.plot.figure9; print('matplotlib' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


@pytest.mark.parametrize(
    ("name", "method", "arguments", "error", "message"),
    [
        ("figure9", "plot_friction", {"axis": 7}, ValueError, "axis: .* from 1 to 6, got 7"),
        ("figure9", "plot_phase", {"axis": 0}, ValueError, "axis: .* from 1 to 6, got 0"),
        ("figure9", "plot_phase", {"axis": 1.0}, TypeError, "axis: .* from 1 to 6, got 1.0"),
        ("figure9", "plot_phase", {"axis": True}, TypeError, "axis: .* from 1 to 6, got True"),
        ("one-axis", "plot_phase", {"axis": 2}, ValueError, "axis: expected axis 1, got 2"),
        ("figure9", "plot_backlash", {"axis": 4}, ValueError, "elastic gear, got axis 4"),
        ("ideal gears", "plot_friction", {}, ValueError, "gears have friction, got model 1"),
        ("figure9", "plot_phase", {"of": "rate"}, ValueError, "of: .* got 'rate'"),
        ("without a motion", "plot_phase", {"of": "error"}, ValueError, "of: .* no control error"),
        ("figure9", "plot_stroboscope", {"n": 1}, ValueError, "n: .* two poses .*, got 1"),
        ("figure9", "plot_stroboscope", {"n": 2.5}, TypeError, "n: .* of poses, got 2.5"),
        ("figure9", "plot_stroboscope", {"view": "front"}, ValueError, "view: .* got 'front'"),
        ("one-axis", "plot_stroboscope", {}, ValueError, "robot with an arm, got model one-axis"),
        ("figure9", "plot_events", {"axes": 3}, TypeError, "axes: expected Axes .*, got 3"),
        ("figure9", "plot", {"axes": "here"}, TypeError, "axes: expected Axes .*, got 'here'"),
    ],
)  # fmt: skip
def test_wrong_arguments_are_named(runs, name, method, arguments, error, message):
    with pytest.raises(error, match=message):
        getattr(runs[name], method)(**arguments)
    assert plt.get_fignums() == []  # no empty figure is left


@pytest.mark.parametrize(
    "name", ["backlash", "events", "figure9", "friction", "phase", "stroboscope"]
)
def test_what_is_no_result_is_refused(name):
    with pytest.raises(TypeError, match="result: expected a Result, got 42"):
        getattr(r3.plot, name)(42)
    with pytest.raises(TypeError, match="compared: expected what `compare` returns, got 42"):
        comparison(42)
