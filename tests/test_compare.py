"""Comparisons: what agrees, how far apart and where the rest is, and which events differ."""

import csv
import dataclasses
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracle_runs import RUNS, stored

import manutec_r3 as r3
from manutec_r3.comparison.results import _Traces, _tube

T_END, DURATION = 0.6, 0.4
END = (0.3, -0.2, 0.4)


def run(*, model=4, start=(0.0, 0.0, 0.0), end=END, t_end=T_END, **options):
    """A quick run, with friction, backlash and dead zones."""
    motion = r3.Quintic(start, end, DURATION)
    return r3.simulate(r3.Robot(model=model), motion, t_end, **options)


@pytest.fixture(scope="module")
def result():
    return run()


def write(path, time, **columns):
    """A file of curves: values to the last digit."""
    with open(path, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time", *columns])
        rows = zip(time, *columns.values(), strict=True)
        table.writerows([repr(float(value)) for value in row] for row in rows)
    return path


# --- two results --------------------------------------------------------------------------------


def test_a_result_agrees_with_itself(result):
    compared = r3.compare(result, result)
    assert compared.agrees
    assert len(compared.curves) == 3 * (len(result.signals) - 1)  # all but the state
    assert all(curve.deviation == 0.0 for curve in compared.curves)
    assert compared.events.same_sequence
    assert compared.events.largest_time_difference == 0.0
    assert len(compared.events.pairs) == len(result.events) > 20
    assert (compared.begin, compared.end) == (0.0, T_END)


def test_every_curve_has_a_unit(result):
    units = {c.signal: c.unit for c in r3.compare(result, result).curves}
    energies = {s: "J" for s in units if s.endswith("energy")}
    powers = {s: "W" for s in units if s.endswith(("power", "loss"))}
    voltages = {s: "V" for s in ("command", "tachogenerator_voltage", "rate_error", "voltage")}
    angles = {s: "rad" for s in units if s.endswith("angle") or s == "control_error"}
    rates = {s: "rad/s" for s in units if s.endswith("rate")}
    torques = {s: "N m" for s in units if s.endswith("torque")}
    others = {"joint_acceleration": "rad/s^2"}
    assert units == angles | rates | torques | voltages | energies | powers | others


def test_jumps_that_tolerances_displace_are_no_deviations(result):
    loose = run(rtol=1e-6)
    compared = r3.compare(loose, result)
    assert compared.agrees
    # The same events, not at the same instants: in between, friction differs by whole jumps.
    apart = compared.events.largest_time_difference
    assert 0.0 < apart == compared.margin < 2e-8  # 2e-9 s is measured
    # 4e-7 of the range is measured, ten times that; jumps of friction are about the whole range.
    assert max(curve.relative_deviation for curve in compared.curves) < 4e-6


def test_a_turn_about_the_vertical_axis_is_the_only_difference_it_makes():
    turn = 0.05
    compared = r3.compare(run(start=(turn, 0.0, 0.0), end=(END[0] + turn, *END[1:])), run())
    moved = {(c.signal, c.axis) for c in compared.curves if not c.agrees}
    assert moved == {(signal, 1) for signal in ("joint_angle", "rotor_angle", "reference_angle")}
    for signal, ratio in {"joint_angle": 1.0, "reference_angle": 1.0, "rotor_angle": 105.0}.items():
        curve = compared.curve(signal, 1)
        assert curve.deviation == pytest.approx(turn * ratio, rel=1e-6)
        assert curve.relative_deviation == curve.deviation / np.ptp(curve.reference)
        assert curve.outside.all()
        assert curve.leaves_at == 0.0
    assert compared.events_agree
    assert not compared.agrees
    # All else is the same but for tolerances: 8e-9 is measured, ten times that.
    rest = [c for c in compared.curves if (c.signal, c.axis) not in moved]
    assert max(c.relative_deviation for c in rest) < 1e-7
    assert compared.worst(3) == sorted(
        (compared.curve(*name) for name in moved), key=lambda c: c.relative_deviation, reverse=True
    )


def test_what_differs_by_less_than_the_tube_agrees_and_is_reported(result):
    turn = 2e-4  # of 0.3 rad: the tube reaches 6e-4
    compared = r3.compare(run(start=(turn, 0.0, 0.0), end=(END[0] + turn, *END[1:])), result)
    assert compared.agrees
    assert compared.curve("reference_angle", 1).deviation == pytest.approx(turn, rel=1e-9)
    assert not r3.compare(
        run(start=(turn, 0.0, 0.0), end=(END[0] + turn, *END[1:])), result, width=2e-4
    ).agrees


def test_the_range_of_an_axis_that_hardly_moves_is_a_thousandth_of_the_largest():
    little = r3.Quintic((0.0, 0.0, 0.0), (2.0, 1e-4, 0.0), 0.4)
    moved = r3.simulate(r3.Robot(model=2), little, 0.4)
    compared = r3.compare(moved, moved, signals=["reference_angle"])
    assert [curve.range for curve in compared.curves] == pytest.approx([2.0, 2e-3, 2e-3])


def test_what_rests_agrees_in_spite_of_roundoff():
    at_rest = [
        r3.simulate(
            r3.Robot(model=1), r3.Hold((0.3, -0.5, 0.8, 0.4, -0.6, 0.2)), 0.3, method=method
        )
        for method in ("erk", "bdf")
    ]
    compared = r3.compare(*at_rest)
    assert max(curve.deviation for curve in compared.curves) > 0.0
    assert compared.agrees


def test_results_are_compared_over_the_time_that_both_have(result):
    compared = r3.compare(run(t_end=0.25), result)
    assert (compared.begin, compared.end) == (0.0, 0.25)
    assert compared.agrees
    assert len(compared.events.pairs) == np.count_nonzero(result.events.time < 0.25)


def test_where_results_were_recorded_does_not_matter(result):
    compared = r3.compare(run(times=[0.0, 0.3]), result)
    assert compared.agrees
    assert all(curve.deviation == 0.0 for curve in compared.curves)


def test_signals_that_one_result_lacks_are_left_out(result):
    pushed = r3.simulate(r3.Robot(model=4, controller=None), None, T_END)
    compared = r3.compare(pushed, result)
    assert {"reference_angle", "control_error", "voltage"}.isdisjoint(
        curve.signal for curve in compared.curves
    )
    with pytest.raises(ValueError, match="signals: expected what both results have, got 'voltage'"):
        r3.compare(pushed, result, signals=["voltage"])


def test_axes_that_both_have_can_be_chosen(result):
    of_six = r3.simulate(r3.Robot(model=3), r3.Quintic([0.0] * 6, [*END, 0, 0, 0], 0.4), T_END)
    compared = r3.compare(of_six, result, signals=["joint_angle"], axes=[1, 3])
    assert [(c.signal, c.axis) for c in compared.curves] == [("joint_angle", 1), ("joint_angle", 3)]
    events = compared.events
    axes = {event.axis for pair in events.pairs for event in pair}
    axes |= {event.axis for event in (*events.extra, *events.missing)}
    assert axes == {0, 1, 3}


def test_states_are_compared_by_their_quantities(result):
    compared = r3.compare(result, result, signals=["pt2_torque", "deflection"])
    assert [curve.unit for curve in compared.curves] == ["N m"] * 3 + ["rad"] * 3
    column = result.robot.state_names.index("deflection[2]")
    curve = compared.curve("deflection", 2)
    recorded = np.isin(curve.time, result.time)
    np.testing.assert_array_equal(curve.value[recorded], result.state[:, column])


# --- the tube -----------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(
    steps=st.lists(st.sampled_from([0.0, 0.1, 0.35, 1.0]), min_size=2, max_size=12),
    seed=st.integers(0, 2**32 - 1),
    reach=st.sampled_from([0.05, 0.3, 2.0]),
)
def test_the_tube_holds_all_values_of_the_reference_within_its_reach(steps, seed, reach):
    random = np.random.default_rng(seed)
    time = np.cumsum([0.0, *steps, 0.2])
    values = random.normal(size=(len(time), 2))
    at = np.sort(random.uniform(0.0, time[-1], 7))
    low, high = _tube(_Traces(time, values), at, reach)
    # The same by brute force: many points on each straight piece.
    part = np.linspace(0.0, 1.0, 2001)[:, None]
    fine_time = (time[:-1] + part * np.diff(time)).T.ravel()
    for curve in range(2):
        fine = (values[:-1, curve] + part * np.diff(values[:, curve])).T.ravel()
        for k, t in enumerate(at):
            near = fine[np.abs(fine_time - t) <= reach + 1e-12]
            # Extremes lie between two points: a piece rises by some 5 at most.
            assert low[k, curve] == pytest.approx(near.min(), rel=0, abs=5e-3)
            assert high[k, curve] == pytest.approx(near.max(), rel=0, abs=5e-3)
            assert low[k, curve] <= near.min() + 1e-9
            assert high[k, curve] >= near.max() - 1e-9


@pytest.mark.parametrize(("shift", "agrees"), [(0.8, True), (-0.8, True), (1.3, False)])
def test_a_jump_may_come_sooner_or_later_by_what_the_tube_reaches(result, tmp_path, shift, agrees):
    tube = 2e-3 * T_END
    time = result.time + shift * tube  # friction jumps by 1 N m when axis 2 reverses
    path = write(
        tmp_path / "curves.csv", time, **{"friction_torque[2]": result.friction_torque[:, 1]}
    )
    inside = r3.compare(result, path)
    assert inside.agrees == agrees


def test_near_a_jump_of_the_file_there_is_a_tube_but_no_deviation(tmp_path):
    at_rest = r3.simulate(r3.Robot(model=2), r3.Hold([0.0, 0.5, 0.0]), T_END)
    begin, end = 0.2, 0.2 + 1e-3  # shorter than the tube reaches
    time = [0.0, begin, begin, end, end, T_END]
    value = at_rest.at(0.0).joint_angle[0, 1] + 0.1 * np.array([0, 0, 1, 1, 0, 0])
    path = write(tmp_path / "jumps.csv", time, **{"joint_angle[2]": value})
    curve = r3.compare(at_rest, path).curve("joint_angle", 2)
    assert curve.agrees
    assert curve.range == pytest.approx(0.1)
    assert curve.deviation < 1e-12  # roundoff; the jumps are 0.1 rad


def test_a_shift_in_time_is_found_where_the_curve_is_steepest(result, tmp_path):
    shift = 4e-3
    time = np.linspace(0.0, T_END, 3001)
    late = result.motion.angle(time - shift)[:, 0]
    path = write(tmp_path / "late.csv", time, **{"reference_angle[1]": late})
    curve = r3.compare(result, path).curve("reference_angle", 1)
    assert not curve.agrees
    # Half-way the quintic has its largest rate, 15/8 of the mean; chord and tangent differ by
    # a part (shift / duration)^2.
    steepest = 15.0 / 8.0 * END[0] / DURATION
    assert curve.deviation == pytest.approx(shift * steepest, rel=1e-3)
    assert curve.instant == pytest.approx((DURATION + shift) / 2.0, abs=2e-4)
    assert r3.compare(result, path, width=shift / T_END).agrees


def test_a_curve_is_outside_where_the_reference_is_elsewhere_for_longer_than_the_tube_reaches(
    result, tmp_path
):
    time = np.linspace(0.0, T_END, 3001)  # the axis is at rest from 0.4 s on, all but
    reference = result.at(time).joint_angle[:, 0]
    tube = 2e-3 * T_END
    for length, agrees in ((1.8 * tube, True), (6.0 * tube, False)):
        there = (time > 0.5) & (time < 0.5 + length)
        path = write(tmp_path / "step.csv", time, **{"joint_angle[1]": reference + 0.03 * there})
        curve = r3.compare(result, path).curve("joint_angle", 1)
        assert curve.agrees == agrees
        assert curve.deviation == pytest.approx(0.03)
        assert 0.5 < curve.instant < 0.5 + length
        if not agrees:
            # The tube is about the step where it is further than its reach from both sides.
            outside = curve.time[curve.outside]
            ends = (curve.leaves_at, outside[-1])
            assert ends == pytest.approx((0.5 + tube, 0.5 + length - tube), abs=4e-4)


# --- files --------------------------------------------------------------------------------------


def test_curves_that_were_written_to_a_file_agree_to_the_last_digit(result, tmp_path):
    columns = {
        f"{signal}[{axis}]": getattr(result, signal)[:, axis - 1]
        for signal in ("joint_angle", "friction_torque", "voltage")
        for axis in (1, 2, 3)
    }
    compared = r3.compare(result, write(tmp_path / "curves.csv", result.time, **columns))
    assert compared.agrees
    assert compared.events is None
    assert [f"{c.signal}[{c.axis}]" for c in compared.curves] == list(columns)
    # Jumps stand twice in the file, and are left out: what is left is the same.
    assert all(curve.deviation == 0.0 for curve in compared.curves)
    assert "the reference has no list" in str(compared)


def test_columns_of_any_name_are_compared_with_what_the_user_says(result, tmp_path):
    path = write(
        tmp_path / "other.csv",
        result.time,
        **{
            "axis2.phi": result.joint_angle[:, 1],
            "axis1.m": result.motor_torque[:, 0],
            "x": 0 * result.time,
        },
    )
    columns = {"axis2.phi": ("joint_angle", 2), "axis1.m": ("motor_torque", 1)}
    compared = r3.compare(result, path, columns=columns)
    assert compared.agrees
    assert [(c.signal, c.axis) for c in compared.curves] == list(columns.values())
    wrong = r3.compare(result, path, columns={"axis2.phi": ("joint_angle", 1)})
    assert not wrong.agrees
    assert r3.compare(result, path, columns=columns, axes=[1]).curves[0].signal == "motor_torque"
    assert len(r3.compare(result, path, columns=columns, signals=["joint_angle"]).curves) == 1


def test_a_file_of_few_instants_is_compared_at_these_alone(result, tmp_path):
    time = np.linspace(0.0, T_END, 7)
    values = result.at(time).joint_rate[:, 0]
    compared = r3.compare(result, write(tmp_path / "few.csv", time, **{"joint_rate[1]": values}))
    assert compared.agrees
    np.testing.assert_array_equal(compared.curves[0].time, time)


def test_an_independent_implementations_curves_agree(tmp_path):
    """Signals at instants that are no multiple of anything, computed by other methods."""
    name = "4-trapezoid"
    expected = stored(name)
    path = write(
        tmp_path / "independent.csv",
        expected.time,
        **{f"joint_angle[{j + 1}]": expected.joint_angle[:, j] for j in range(3)},
    )
    compared = r3.compare(RUNS[name].simulate(), path)
    assert compared.agrees
    assert max(curve.relative_deviation for curve in compared.curves) < 1e-6


# --- events -------------------------------------------------------------------------------------

SOME = r3.Events(
    [
        (0.1, 1, "friction", 0, 1),
        (0.2, 2, "dead_zone", 0, -1),
        (0.3, 1, "backlash", 0, 1),
        (0.3, 2, "backlash", 0, -1),
        (0.4, 0, "reference", 0, 0),
        (0.5, 1, "friction", 1, 0),
    ]
)


def changed(**rows):
    """Some events, rows of them put in place of others; None: none."""
    events = {f"row_{k}": [event] for k, event in enumerate(SOME)}
    events |= {row: [] if event is None else [event] for row, event in rows.items()}
    return r3.Events(event for group in events.values() for event in group)


def test_the_same_events_are_the_same():
    compared = r3.compare_events(SOME, SOME)
    assert compared.same_sequence
    assert compared.pairs == tuple((event, event) for event in SOME)
    assert compared.first_difference is None


def test_an_event_that_is_missing_is_found():
    compared = r3.compare_events(changed(row_2=None), SOME)
    assert compared.missing == (SOME[2],)
    assert compared.extra == ()
    assert compared.first_difference == (SOME[3], SOME[2])
    assert len(compared.pairs) == 5


def test_an_event_that_is_too_many_is_found_at_the_end_as_well():
    compared = r3.compare_events(SOME, changed(row_5=None))
    assert compared.extra == (SOME[5],)
    assert compared.missing == ()
    assert compared.first_difference == (SOME[5], None)


def test_an_event_that_has_moved_is_the_same_event_further_away():
    moved = changed(row_1=(0.23, 2, "dead_zone", 0, -1))
    compared = r3.compare_events(moved, SOME)
    assert compared.same_sequence
    assert compared.largest_time_difference == pytest.approx(0.03)
    assert compared.furthest == (moved[1], SOME[1])


def test_an_event_of_another_branch_is_another_event():
    compared = r3.compare_events(changed(row_0=(0.1, 1, "friction", 0, -1)), SOME)
    assert not compared.same_sequence
    assert compared.first_difference == ((0.1, 1, "friction", 0, -1), SOME[0])
    assert (len(compared.extra), len(compared.missing)) == (1, 1)


def test_events_in_another_order_are_a_difference():
    swapped = changed(row_0=(0.1, 2, "dead_zone", 0, -1), row_1=(0.2, 1, "friction", 0, 1))
    compared = r3.compare_events(swapped, SOME)
    assert not compared.same_sequence
    assert compared.first_difference == (swapped[0], SOME[0])


@pytest.mark.parametrize("apart", [0.0, 1e-13])
def test_events_of_one_instant_have_no_order(apart):
    swapped = changed(row_2=(0.3, 2, "backlash", 0, -1), row_3=(0.3 + apart, 1, "backlash", 0, 1))
    for compared in (r3.compare_events(swapped, SOME), r3.compare_events(SOME, swapped)):
        assert compared.same_sequence
        assert compared.largest_time_difference == pytest.approx(apart, abs=1e-16)


def test_events_that_are_of_one_instant_in_one_list_have_no_order_in_the_other():
    ours = changed(row_2=(0.3, 2, "backlash", 0, -1), row_3=(0.3 + 1e-9, 1, "backlash", 0, 1))
    for compared in (r3.compare_events(ours, SOME), r3.compare_events(SOME, ours)):
        assert compared.same_sequence


def test_events_of_one_instant_have_no_order_behind_a_difference_either():
    swapped = {"row_2": (0.3, 2, "backlash", 0, -1), "row_3": (0.3, 1, "backlash", 0, 1)}
    compared = r3.compare_events(changed(row_0=None, **swapped), SOME)
    assert compared.missing == (SOME[0],)
    assert compared.extra == ()


def test_one_event_that_is_missing_is_found_in_a_long_list_of_few_kinds():
    many = [(0.01 * k, 1, "friction", k % 2, (k + 1) % 2) for k in range(400)]
    compared = r3.compare_events(r3.Events(many[1:]), r3.Events(many))
    assert compared.missing == (many[0],)
    assert compared.largest_time_difference == 0.0


def test_of_one_instant_what_is_in_both_is_no_difference():
    compared = r3.compare_events(changed(row_3=(0.3, 3, "backlash", 0, -1)), SOME)
    assert compared.first_difference == ((0.3, 3, "backlash", 0, -1), SOME[3])
    assert (len(compared.extra), len(compared.missing)) == (1, 1)


def test_events_that_are_further_apart_than_roundoff_have_an_order():
    ours = changed(row_2=(0.3, 2, "backlash", 0, -1), row_3=(0.3 + 1e-9, 1, "backlash", 0, 1))
    theirs = changed(row_3=(0.3 + 1e-9, 2, "backlash", 0, -1))
    assert not r3.compare_events(ours, theirs).same_sequence
    assert r3.compare_events(ours, theirs, roundoff=1e-8).same_sequence


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_whatever_one_event_is_lost_is_the_one_that_is_missing(data):
    kinds = st.tuples(st.integers(1, 3), st.sampled_from(["friction", "backlash"]))
    switches = data.draw(st.lists(kinds, min_size=1, max_size=30))
    all_of_them = [(0.1 * k, axis, kind, 0, 1) for k, (axis, kind) in enumerate(switches)]
    lost = data.draw(st.integers(0, len(all_of_them) - 1))
    rest = all_of_them[:lost] + all_of_them[lost + 1 :]
    compared = r3.compare_events(r3.Events(rest), r3.Events(all_of_them))
    # Of several alike in a row, it cannot be told which one is missing.
    (missing,) = compared.missing
    assert missing[1:] == all_of_them[lost][1:]
    assert compared.extra == ()
    assert len(compared.pairs) == len(rest)


def test_events_too_far_apart_do_not_agree_although_their_sequence_is_the_same(result):
    compared = r3.compare(result, result)
    assert compared.agrees
    (event, _), *rest = compared.events.pairs
    for shift, agrees in ((0.9 * compared.tube, True), (1.1 * compared.tube, False)):
        pairs = ((event._replace(time=event.time + shift), event), *rest)
        events = dataclasses.replace(compared.events, pairs=pairs)
        assert dataclasses.replace(compared, events=events).agrees == agrees


def test_events_that_are_listed_on_request_are_not_compared(result):
    more = pickle.loads(pickle.dumps(result))
    more.events = r3.Events([(0.008, 0, "sample", 0, 0), (0.01, 2, "limit", 0, 1), *result.events])
    compared = r3.compare(more, result)
    assert compared.agrees
    assert not r3.compare_events(more.events, result.events).same_sequence


# --- what comes out -----------------------------------------------------------------------------


def test_a_comparison_says_in_words_what_it_found(result):
    assert str(r3.compare(result, result)).startswith("agrees from 0 to 0.6 s\ncurves: 72 of 72 ")
    other = run(end=(0.3, -0.2, 0.45))
    compared = r3.compare(other, result)
    said = str(compared)
    assert said.startswith("differs from 0 to 0.6 s")
    first = compared.events.first_difference[1]
    assert f"in the reference {first.element.replace('_', ' ')} of axis {first.axis} at" in said
    curve = max(
        (c for c in compared.curves if c.signal == "reference_angle"),
        key=lambda c: c.relative_deviation,
    )
    (line,) = (line for line in said.splitlines() if "reference_angle" in line)
    assert f"{curve.deviation:.1e} rad" in line
    assert f"axis 3 at {curve.instant:.6g} s; outside: axis 3 from {curve.leaves_at:.6g} s" in line


def test_a_comparison_cannot_be_changed(result):
    compared = r3.compare(result, result)
    with pytest.raises(dataclasses.FrozenInstanceError):
        compared.margin = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        compared.curves[0].deviation = 1.0
    arrays = ("time", "value", "lower", "upper", "reference_time", "reference", "difference_time")
    for name in (*arrays, "difference"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(compared.curves[0], name)[0] = 1.0


def test_a_comparison_survives_pickling(result):
    compared = r3.compare(run(rtol=1e-6), result)
    assert str(pickle.loads(pickle.dumps(compared))) == str(compared)


# --- mistakes -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"reference": 3}, "reference: expected a Result or the path of a file, got 3"),
        ({"result": "a.csv"}, "result: expected a Result, got 'a.csv'"),
        ({"width": 0.0}, "width: expected a part of the range between 0 and 1, got 0"),
        ({"width": float("nan")}, "width: expected a finite number"),
        ({"width": "wide"}, "width: expected one number"),
        ({"signals": "joint_angle"}, "signals: expected a sequence of names, got 'joint_angle'"),
        ({"signals": ["joint_angel"]}, "signals: expected some of joint_angle, .*'joint_angel'"),
        ({"signals": []}, "expected curves that both sides have, there are none"),
        ({"axes": [4]}, "axes: expected integers from 1 to 3, got 4"),
        ({"axes": [0]}, "axes: expected integers from 1 to 3, got 0"),
        ({"axes": [1.0]}, "axes: expected integers from 1 to 3, got 1.0"),
        ({"axes": 2}, "axes: expected a sequence of integers, got 2"),
        ({"columns": {}}, "columns: expected none for a reference that is a Result"),
    ],
)
def test_wrong_arguments_are_refused(result, arguments, message):
    with pytest.raises((TypeError, ValueError), match=message):
        r3.compare(**{"result": result, "reference": result} | arguments)


def test_results_of_other_axes_need_to_be_told_which(result):
    of_six = r3.simulate(r3.Robot(model=3), r3.Hold([0.0] * 6), 0.1)
    with pytest.raises(ValueError, match=r"axes: expected those to compare, .* have 6 and 3 axes"):
        r3.compare(of_six, result)


def test_an_unknown_curve_was_not_compared(result):
    compared = r3.compare(result, result, axes=[1])
    with pytest.raises(ValueError, match="'joint_angle' of axis 2 was not compared"):
        compared.curve("joint_angle", 2)


@pytest.mark.parametrize(
    ("text", "columns", "message"),
    [
        ("", None, "expected names of columns, time first"),
        ("time;joint_angle[1]\n0;1\n", None, "with commas between, got .*;"),
        ("time,joint_angle[1]\n0,1\n", None, "expected two lines of numbers or more, got 1"),
        ("time,joint_angle[1]\n0,1\n1\n", None, "line 3: expected 2 numbers, got 1"),
        ("time,joint_angle[1]\n0,1\n1,x\n", None, "line 3, column 'joint_angle.1.': .* got 'x'"),
        ("time,joint_angle[1]\n0,1\n1,nan\n", None, "expected a finite number, got 'nan'"),
        ("time,joint_angle[1]\n0,1\n-1,1\n", None, "do not decrease, got -1 after 0"),
        ("time,phi\n0,1\n1,1\n", None, "named such as 'joint_angle.1.', got 'phi'"),
        ("time,joint_angle[4]\n0,1\n1,1\n", None, "columns: .* from 1 to 3, got 4"),
        ("time,joint_angel[1]\n0,1\n1,1\n", None, "columns: expected some of .*'joint_angel'"),
        ("time,a\n0,1\n1,1\n", {"b": ("voltage", 1)}, "expected a column 'b', got time, a"),
        ("time,a\n0,1\n1,1\n", {"a": "voltage[1]"}, "expected .signal, axis. for 'a', got 'volt"),
        ("time,a\n0,1\n1,1\n", ["a"], "columns: expected {'name': .signal, axis.}, got"),
        ("time,a\n0,1\n1,1\n", {"a": ("voltage", "1")}, "columns: expected integers .* got '1'"),
        ("time,a\n0,1\n1,1\n", {}, "there are none"),
        (
            "time,a,b\n0,1,1\n1,1,1\n",
            {"a": ("voltage", 1), "b": ("voltage", 1)},
            "column 'b': there are two columns of voltage.1.",
        ),
        ("time,joint_angle[1]\n2,1\n3,1\n", None, "expected two instants or more from 0 to 0.6 s"),
    ],
)
def test_wrong_files_are_refused(result, tmp_path, text, columns, message):
    path = tmp_path / "curves.csv"
    path.write_text(text)
    with pytest.raises((TypeError, ValueError), match=message):
        r3.compare(result, path, columns=columns)


def test_a_file_that_is_not_there_is_an_error_of_the_system(result, tmp_path):
    with pytest.raises(FileNotFoundError):
        r3.compare(result, tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"events": [SOME[0]]}, "events: expected Events, such as result.events"),
        ({"reference": None}, "reference: expected Events, such as result.events, got None"),
        ({"roundoff": -1.0}, "roundoff: expected a time that is not negative, got -1 s"),
        ({"roundoff": np.inf}, "roundoff: expected a finite number"),
    ],
)
def test_wrong_lists_of_events_are_refused(arguments, message):
    with pytest.raises((TypeError, ValueError), match=message):
        r3.compare_events(**{"events": SOME, "reference": SOME} | arguments)
