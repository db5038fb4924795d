// The exact solution of linear blocks (solver/propagator.hpp) against closed forms.
#include "solver/propagator.hpp"

#include <array>
#include <cmath>
#include <thread>
#include <vector>

#include "check.hpp"

namespace manutec_r3::testing {
namespace {

using solver::input_degree;
using solver::n_nodes;
using solver::Propagator;

// x' = -a x + b + f + r, of which b is constant, f forcing, r a remainder.
hybrid::LinearBlock lag(double a) {
  hybrid::LinearBlock block;
  block.states = {0};
  block.watched = {0};
  block.L = Eigen::MatrixXd::Constant(1, 1, -a);
  block.B = Eigen::MatrixXd::Ones(1, 3);
  block.n_constants = block.n_forcing = block.n_remainder = 1;
  return block;
}

// x'' = -w^2 x - 2 D w x' + w^2 r, which is fast, and moves p' = x.
hybrid::LinearBlock oscillator(double w, double D) {
  hybrid::LinearBlock block;
  block.states = {0, 1, 2};
  block.watched = {2, 0};
  block.L.setZero(3, 3);
  block.L << 0, 1, 0, -w * w, -2 * D * w, 0, 1, 0, 0;
  block.B.setZero(3, 1);
  block.B(1, 0) = w * w;
  block.n_constants = block.n_forcing = 0;
  block.n_remainder = 1;
  return block;
}

// After a time t with the input r = t^q from rest, for a lag: x' = -a x + t^q.
double lag_after(double a, double t, int q) {
  // int_0^t exp(-a (t - tau)) tau^q dtau by parts; for short times by its series.
  if (a * t < 0.5) {
    double sum = 0.0, term = std::pow(t, q + 1) / (q + 1);
    for (int i = 0; i < 30; ++i) {
      sum += term;
      term *= -a * t / (q + 2 + i);
    }
    return sum;
  }
  double value = (1.0 - std::exp(-a * t)) / a;
  for (int k = 1; k <= q; ++k) value = (std::pow(t, k) - k * value) / a;
  return value;
}

// x' = -a x, which is slow, and y' = -b y + x, which is fast and makes the ladder long.
hybrid::LinearBlock slow_and_fast(double a, double b) {
  hybrid::LinearBlock block;
  block.states = {0, 1};
  block.watched = {0};
  block.L.setZero(2, 2);
  block.L << -a, 0, 1, -b;
  block.B.setZero(2, 1);
  block.n_constants = block.n_forcing = 0;
  block.n_remainder = 1;
  return block;
}

TEST(WhatHardlyMovesKeepsItsDigits) {
  // A doubling of the length must not double the roundoff of what is almost 1.
  for (const double a : {1e-3, 1.0, 10.0}) {
    const Propagator propagator(slow_and_fast(a, 7e3));
    CHECK(propagator.n_rungs() > 8);
    std::vector<double> coefficients(propagator.columns(), 0.0);
    coefficients[0] = 1.0;
    solver::BlockState x{};
    propagator.advance(0, coefficients.data(), x.data());
    const double move = std::expm1(-a * Propagator::length(0));
    CHECK_NEAR(x[0], 1.0 + move, 2e-16 + 1e-14 * std::abs(move));  // one rounding of x
    solver::BlockState end{};
    propagator.step(0).end.product(coefficients.data(), end.data());
    CHECK_NEAR(end[0], 1.0 + std::expm1(-a * input_degree * Propagator::length(0)),
               2e-16 + 1e-14 * std::abs(input_degree * move));
  }
}

TEST(ALadderOfLengthsIsTheExponential) {
  for (const double a : {0.0, 3.0, 1e3, 3e4}) {
    const Propagator propagator(lag(a));
    for (int rung = 0; rung < 12; ++rung) {
      const double d = Propagator::length(rung);
      std::vector<double> coefficients(propagator.columns(), 0.0);
      coefficients[0] = 1.0;
      solver::BlockState x{};
      propagator.advance(rung, coefficients.data(), x.data());
      // A dozen roundings, doubled up to ten times.
      CHECK_NEAR(x[0], std::exp(-a * d), 1e-13);
    }
  }
}

TEST(InputsOfEveryDegreeAndKindAreIntegratedExactly) {
  for (const double a : {0.5, 2e3}) {
    const Propagator propagator(lag(a));
    const double d = Propagator::length(2);
    const auto& step = propagator.step(2);
    for (int q = 0; q <= input_degree; ++q) {
      // t^q at the nodes, as forcing and as remainder.
      for (const int first : {2, 2 + n_nodes}) {
        std::vector<double> coefficients(propagator.columns(), 0.0);
        for (int l = 0; l < n_nodes; ++l) coefficients[first + l] = std::pow(l * d, q);
        solver::BlockAtNodes watched{}, rates{};
        step.watched.product(coefficients.data(), watched.data());
        step.rates.product(coefficients.data(), rates.data());
        for (int node = 1; node < n_nodes; ++node) {
          const double t = node * d;
          const double expected = lag_after(a, t, q);
          const double scale = std::pow(input_degree * d, q + 1);
          CHECK_NEAR(watched[node - 1], expected, 1e-13 * scale);
          CHECK_NEAR(rates[node - 1], std::pow(t, q) - a * expected, 1e-12 * scale * (a + 1.0 / d));
        }
        solver::BlockState end{};
        step.end.product(coefficients.data(), end.data());
        CHECK_NEAR(end[0], lag_after(a, input_degree * d, q),
                   1e-13 * std::pow(input_degree * d, q + 1));
      }
    }
    // A constant.
    std::vector<double> coefficients(propagator.columns(), 0.0);
    coefficients[1] = 1.0;
    solver::BlockState end{};
    step.end.product(coefficients.data(), end.data());
    CHECK_NEAR(end[0], lag_after(a, input_degree * d, 0), 1e-15);
  }
}

TEST(FastOscillationsAreExactOverManyOfTheirPeriods) {
  // As the motors of the robot: 0.3 periods a rung, and undamped, 40 periods a step.
  for (const auto& [w, D] : {std::pair{7400.0, 0.27}, {3e4, 0.0}}) {
    const Propagator propagator(oscillator(w, D));
    const double t = input_degree * Propagator::longest;
    std::vector<double> coefficients(propagator.columns(), 0.0);
    coefficients[0] = 1.0;
    solver::BlockState end{};
    propagator.step(0).end.product(coefficients.data(), end.data());
    const double w_d = w * std::sqrt(1.0 - D * D), decay = std::exp(-D * w * t);
    const double expected = decay * (std::cos(w_d * t) + D * w / w_d * std::sin(w_d * t));
    CHECK_NEAR(end[0], expected, 1e-12);  // ten doublings of roundoff
    // p' = x, so p is (2 D x_0 w - x' + ...)/w^2: from x'' + 2 D w x' + w^2 x = 0.
    CHECK_NEAR(end[2], -(end[1] + 2.0 * D * w * (end[0] - 1.0)) / (w * w), 1e-15);
  }
}

TEST(AStepMadeToMeasureIsLikeOneOfTheLadder) {
  const Propagator propagator(oscillator(5500.0, 0.6));
  const auto measured = propagator.step_of(Propagator::length(1));
  std::vector<double> coefficients(propagator.columns());
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] = std::cos(1.0 + k);
  solver::BlockState left{}, right{};
  propagator.step(1).end.product(coefficients.data(), left.data());
  measured.end.product(coefficients.data(), right.data());
  for (int s = 0; s < 3; ++s) CHECK_NEAR(left[s], right[s], 1e-13 * 5500.0);
}

TEST(TaylorsSeriesGoesOnWhereTheLadderEnds) {
  const Propagator propagator(oscillator(7400.0, 0.27));
  const int last = propagator.n_rungs() - 1;
  std::vector<double> coefficients(propagator.columns());
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] = std::sin(1.0 + k);
  for (std::size_t k = 4; k < coefficients.size(); ++k) coefficients[k] *= 1e3;  // derivatives
  std::vector<double> terms(Propagator::n_terms * propagator.padded_states());
  propagator.expand(coefficients.data(), terms.data());
  solver::BlockState by_series{}, by_ladder{};
  propagator.sum(terms.data(), Propagator::length(last), by_series.data());
  propagator.advance(last, coefficients.data(), by_ladder.data());
  for (int s = 0; s < 3; ++s) CHECK_NEAR(by_series[s], by_ladder[s], 1e-14 * 7400.0);
}

TEST(EqualBlocksShareTheirPropagator) {
  const auto one = solver::propagator_of(lag(3.0)), same = solver::propagator_of(lag(3.0));
  const auto other = solver::propagator_of(lag(std::nextafter(3.0, 4.0)));
  CHECK(one == same);
  CHECK(one != other);
  // Also when several threads ask at once, for a step, too.
  std::vector<std::shared_ptr<const Propagator>> got(8);
  std::vector<const solver::StepMatrices*> steps(8);
  {
    std::vector<std::jthread> threads;
    for (int k = 0; k < 8; ++k) {
      threads.emplace_back([&, k] {
        got[k] = solver::propagator_of(oscillator(123.0, 0.5));
        steps[k] = &got[k]->step(4);
      });
    }
  }
  for (int k = 1; k < 8; ++k) {
    CHECK(got[k] == got[0]);
    CHECK(steps[k] == steps[0]);
  }
}

TEST(ABlockThatIsTooLargeIsRefused) {
  hybrid::LinearBlock block = lag(1.0);
  block.states.resize(solver::most_states + 1);
  block.L.setZero(solver::most_states + 1, solver::most_states + 1);
  block.B.setZero(solver::most_states + 1, 3);
  CHECK_THROWS(Propagator{block}, std::invalid_argument);
}

}  // namespace
}  // namespace manutec_r3::testing
