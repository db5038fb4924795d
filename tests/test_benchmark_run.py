"""The benchmark run of specification section 10: what two trial implementations agreed on."""

import json
from collections import Counter
from importlib.resources import files

import numpy as np
import pytest
from oracle_runs import RUNS, stored, times_of

from manutec_r3.comparison.accuracy import sequence

RUN = RUNS["section-10"]
PRINTED = json.loads(
    (files("manutec_r3.comparison") / "references" / "figure9_quintic.json").read_text()
)


@pytest.fixture(scope="module", params=["exponential", "erk", "bdf"])
def result(request):
    return RUN.simulate(method=request.param)


def test_peak_control_errors_have_the_printed_digits(result):
    peaks = np.abs(result.control_error).max(axis=0)
    np.testing.assert_array_equal(np.round(peaks, 5), PRINTED["control_error"])


def test_peak_motor_torques_have_the_printed_digits(result):
    peaks = np.abs(result.motor_torque).max(axis=0)
    np.testing.assert_array_equal(np.round(peaks, 2), PRINTED["motor_torque"])


def test_there_are_sixty_events_with_the_printed_counts(result):
    assert Counter(event.element for event in result.events) == PRINTED["events"]
    assert result.statistics.events == 60


def test_every_axis_sticks_at_some_time(result):
    assert np.all(result.branches["friction"] == 0, axis=1)[0]
    breaks_away = [e.axis for e in result.events if e.element == "friction" and e.before == 0]
    assert set(breaks_away) == {1, 2, 3, 4, 5, 6}


def test_the_end_of_the_motion_is_an_event_of_the_whole_robot(result):
    assert [event for event in result.events if event.axis == 0] == [(1.2, 0, "reference", 0, 0)]


@pytest.mark.parametrize(
    # Promised are 1e-6 s at default tolerances; measured are 1e-8 s (exponential),
    # 2e-10 s (erk) and 3e-9 s (bdf). At a
    # tolerance of 1e-12 what is left is the accuracy of the independent implementation, 4e-13 s.
    # Ten times that.
    ("options", "accuracy"),
    [
        ({"method": "exponential"}, 1e-7),
        ({}, 2e-9),
        ({"method": "bdf"}, 3e-8),
        ({"method": "erk", "rtol": 1e-12}, 4e-12),
    ],
    ids=["exponential", "erk", "bdf", "erk 1e-12"],
)
def test_events_are_those_of_the_independent_implementation(options, accuracy):
    events, expected = RUN.simulate(**options).events, stored("section-10").events
    assert sequence(events) == sequence(expected)
    assert times_of(events) == pytest.approx(times_of(expected), rel=0, abs=accuracy)


def test_the_stored_events_come_from_the_independent_implementation():
    again = RUN.simulate_independently(0.05, rtol=1e-10)
    expected = [event for event in stored("section-10").events if event[0] < 0.05]
    assert sequence(again.events) == sequence(expected)
    assert len(expected) >= 5
    # The tolerance of this repetition is a hundred times that of the stored run. Its short steps
    # keep errors at 4e-15 s; other versions of NumPy and SciPy may round otherwise.
    assert times_of(again.events) == pytest.approx(times_of(expected), rel=0, abs=1e-12)
