"""Motions whose pieces are polynomials that somebody else has computed."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import PPoly

import manutec_r3 as r3

EPS = np.finfo(float).eps
QUANTITIES = ("angle", "rate", "acceleration")
UP, DOWN = [[0.0], [0.0], [1.0]], [[1.0], [0.0], [-1.0]]
few = settings(max_examples=50, deadline=None)


@st.composite
def pieces(draw, n_axes=3):
    """Times and coefficients (n, n_powers, n_axes); each piece goes on where the last has ended."""
    lengths = draw(st.lists(st.floats(0.02, 1.0), min_size=1, max_size=5))
    times = draw(st.floats(0.0, 1.0)) + np.cumsum([0.0, *lengths])
    n_powers = draw(st.integers(1, 6))
    row = st.lists(st.floats(-3.0, 3.0), min_size=n_axes, max_size=n_axes)
    size = n_powers * len(lengths)
    numbers = draw(st.lists(row, min_size=size, max_size=size))
    coefficients = np.array(numbers).reshape(len(lengths), n_powers, n_axes)
    for k in range(1, len(lengths)):
        coefficients[k, 0] = coefficients[k - 1].sum(axis=0)
    return times, coefficients


@few
@given(given_pieces=pieces())
def test_pieces_are_the_polynomials_of_normalised_time(given_pieces):
    times, coefficients = given_pieces
    motion = r3.PiecewisePolynomial(times, coefficients)
    length = np.diff(times)
    of_time = coefficients / length[:, None, None] ** np.arange(coefficients.shape[1])[:, None]
    expected = PPoly(np.moveaxis(of_time[:, ::-1], 0, 1), times)
    t = np.linspace(times[0], times[-1], 200)[1:-1]
    for derivative, quantity in enumerate(QUANTITIES):
        # 3 rad times 5 pieces, 6 powers and 5 * 4 of the derivatives, and the shortest of the
        # pieces magnifies roundoff with each derivative; measured 10 times less.
        tolerance = 2000 * EPS / length.min() ** derivative
        np.testing.assert_allclose(
            getattr(motion, quantity)(t), expected(t, derivative), rtol=0, atol=tolerance
        )


@few
@given(given_pieces=pieces())
def test_it_rests_before_and_after_and_every_time_is_a_knot(given_pieces):
    times, coefficients = given_pieces
    motion = r3.PiecewisePolynomial(times, coefficients)
    np.testing.assert_array_equal(motion.knots, times)
    assert motion.duration == times[-1]
    np.testing.assert_array_equal(motion.angle(times[0] - 1e-3), coefficients[0, 0])
    np.testing.assert_allclose(  # a sum of six, in another order
        motion.angle(times[-1] + 1.0), coefficients[-1].sum(axis=0), rtol=0, atol=100 * EPS
    )
    for outside in (times[0] - 1e-3, times[-1] + 1.0):
        assert not motion.rate(outside).any()
        assert not motion.acceleration(outside).any()


def test_a_quintic_written_as_a_polynomial_moves_alike():
    end = np.array([1.0, 1.0, 0.6, -0.2, -0.15, -0.1])
    quintic = r3.Quintic([0.0] * 6, end, 1.2)
    same = r3.PiecewisePolynomial([0.0, 1.2], [np.multiply.outer([0, 0, 0, 10, -15, 6], end)])
    t = np.linspace(-0.1, 1.199, 57)  # the angle at its end is a sum, and known to roundoff only
    for quantity in QUANTITIES:
        np.testing.assert_array_equal(getattr(same, quantity)(t), getattr(quintic, quantity)(t))


def test_it_is_a_value():
    motion = r3.PiecewisePolynomial([0.0, 0.5, 1.0], [UP, DOWN])
    again = pickle.loads(pickle.dumps(motion))
    assert again == motion
    assert hash(again) == hash(motion)
    assert motion != r3.PiecewisePolynomial([0.0, 0.5, 1.1], [UP, DOWN])
    assert motion != r3.Hold([0.0])
    assert repr(motion) == "PiecewisePolynomial(2 pieces of 1 axes, 0 to 1 s)"


def test_a_file_holds_it_without_loss(tmp_path):
    # Numbers that have no short decimal representation.
    up = (np.array([[0.0], [0.1], [0.3]]) / 3.0).tolist()
    motion = r3.PiecewisePolynomial([0.1, 0.7], [up])
    scenario = r3.Scenario("lift", r3.Robot(model="one-axis"), motion, t_end=1.0)
    scenario.save(tmp_path / "lift.toml")
    assert r3.Scenario.load(tmp_path / "lift.toml") == scenario


@pytest.mark.parametrize(
    ("times", "coefficients", "error", "message"),
    [
        ([0.0], [], ValueError, r"coefficients: expected shape \(0, n_powers, n_axes\)"),
        ([0.0, 1.0], [[0.0]], ValueError, r"got shape \(1, 1\)"),
        ([0.0, 1.0], [UP, DOWN], ValueError, r"shape \(1, n_powers, n_axes\).*\(2, 3, 1\)"),
        ([0.0, 1.0], [["up"]], TypeError, "coefficients: expected numbers"),
        ([-1.0, 1.0], [UP], ValueError, r"times\[0\]: expected a finite time from 0 s on, got -1"),
        ([0.0, 0.0], [UP], ValueError, r"times\[1\]: expected a finite time after 0 s, got 0"),
        ([0.0, np.inf], [UP], ValueError, r"times\[1\]: expected a finite time after 0 s"),
        ([0.0, 1.0], [[[0.0, 1.0]]], ValueError, "expected 1, 3 or 6 angles"),
        ([0.0, 1.0], [[[0.0]] * 7], ValueError, r"1 to 6 powers, x\^0 to x\^5, got 7"),
        ([0.0, 1.0], np.zeros((1, 0, 3)), ValueError, r"got shape \(1, 0, 3\)"),
        ([0.0, 1.0], [[[1e308]] * 6], ValueError, r"coefficients\[0\] of axis 1: expected finite"),
        ([0.0, 5e-324], [[[0.0], [1.0]]], ValueError, r"coefficients\[0\] of axis 1: expected fin"),
        (
            [0.0, 1.0],
            [[[0.0] * 3, [0.0, 0.0, np.nan]]],
            ValueError,
            r"coefficients\[0\] of x\^1 of axis 3: expected a finite value \[rad\], got nan",
        ),
        (
            [0.0, 0.5, 1.0],
            [UP, [[0.9], [0.0], [0.0]]],
            ValueError,
            r"coefficients\[1\]: expected to begin on axis 1 at 1 rad, where coefficients\[0\] "
            "ends at 0.5 s, got 0.9",
        ),
    ],
)
def test_a_mistake_is_refused_at_the_door(times, coefficients, error, message):
    with pytest.raises(error, match=message):
        r3.PiecewisePolynomial(times, coefficients)
