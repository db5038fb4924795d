#include "solver/exponential_collocation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hybrid/crossing.hpp"
#include "hybrid/failure.hpp"

namespace manutec_r3::solver {
namespace {

// The first step of a run, if nothing is known: 1 ms.
constexpr int first_rung = 3;
// Sweeps end when what they may still change is less than this part of the tolerance.
constexpr double settled_enough = 0.3;
constexpr int most_sweeps = 12;
// By how much a first sweep is believed to be worse than a second; after it it is known.
constexpr double first_contraction = 0.1;
// Intervals twice as long make the error 2^5 times as large; some of it is left as a reserve.
constexpr double allows_twice_as_long = 0.7 / 32.0;
// Polynomials of the step before are not trusted further than so many intervals beyond it.
constexpr double furthest_prediction = input_degree + 4.0;

hybrid::LinearView& linear_view_of(hybrid::System& system) {
  if (hybrid::LinearView* view = system.linear_view()) return *view;
  throw std::invalid_argument("exponential: expected a system with a linear view");
}

}  // namespace

ExponentialCollocation::ExponentialCollocation(hybrid::System& system, double relative_tolerance)
    : system_(system),
      view_(linear_view_of(system)),
      tolerance_(relative_tolerance),
      blocks_(view_),
      record_(system.n_states(), blocks_),
      inside_(system.n_states(), blocks_),
      x_(system.n_states()),
      matrices_(blocks_.size()),
      forcing_(n_nodes * blocks_.n_forcing()),
      remainder_(n_nodes * blocks_.n_remainder()),
      change_(blocks_.n_remainder()),
      sensitivity_(blocks_.n_forcing() + blocks_.n_remainder()),
      coefficients_(blocks_.size()),
      settled_(blocks_.size()),
      found_(blocks_.size()),
      x_node_(n_nodes, std::vector<double>(system.n_states())) {
  before_.remainder.resize(remainder_.size());
  kept_.x.resize(x_.size());
  kept_.remainder.resize(blocks_.n_remainder());
}

void ExponentialCollocation::restart(double t, const double* x, double size) {
  blocks_.refresh();
  t_ = t;
  std::copy_n(x, x_.size(), x_.begin());
  kept_.known = false;
  n_looks_ = 0;
  rung_ = first_rung;
  if (size > 0.0) {
    const double halvings = std::log2(input_degree * Propagator::longest / size);
    rung_ = std::clamp(static_cast<int>(std::lround(halvings)), 0, Propagator::lowest_rung);
  }
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Propagator& propagator = *blocks_[b].propagator;
    coefficients_[b].resize(propagator.columns());
    settled_[b].resize(input_degree * propagator.padded_watched());
    found_[b].resize(settled_[b].size());
  }
}

double ExponentialCollocation::next_size() const {
  return input_degree * Propagator::length(rung_);
}

void ExponentialCollocation::remember(const hybrid::Step& step) {
  before_.known = static_cast<int>(step.dense.size()) == record_.size;
  if (!before_.known) return;
  before_.begin = step.dense[record_.begin];
  before_.interval = step.dense[record_.interval];
  std::copy_n(&step.dense[record_.remainder], before_.remainder.size(), before_.remainder.begin());
}

// --- a step --------------------------------------------------------------------------------------

void ExponentialCollocation::advance(double stop, hybrid::Step& step, double* x1) {
  const double remaining = stop - t_;
  begin_ = t_;
  std::copy_n(remainder_at(t_, x_.data()), blocks_.n_remainder(), remainder_.begin());
  int rung = rung_;
  for (;;) {
    // No longer than it takes to reach the stop.
    while (rung < Propagator::lowest_rung &&
           input_degree * Propagator::length(rung + 1) >= remaining) {
      ++rung;
    }
    const bool too_long = input_degree * Propagator::length(rung) > remaining;
    if (too_long && !view_.extends_beyond_events()) {
      use_length(remaining / input_degree);
    } else {
      use_rung(rung);
    }
    const double error = attempt(interval_);
    if (error <= 1.0) {
      if (rung == rung_ && error < allows_twice_as_long) rung_ = std::max(rung_ - 1, 0);
      break;
    }
    ++work_.rejected_steps;
    rung_ = ++rung;
    if (rung > Propagator::lowest_rung || t_ + Propagator::length(rung) == t_) {
      rung_ = first_rung;
      throw hybrid::SimulationFailure("steps have become too short to advance the time");
    }
  }
  ++work_.steps;

  step.dense.resize(record_.size);
  step.dense[record_.begin] = begin_;
  step.dense[record_.interval] = interval_;
  std::ranges::copy(x_, &step.dense[record_.x]);
  std::ranges::copy(forcing_, &step.dense[record_.forcing]);
  std::ranges::copy(remainder_, &step.dense[record_.remainder]);
  step.t0 = begin_;
  const double end = begin_ + input_degree * interval_;
  const double tiny = hybrid::simultaneous(stop);
  step.t1 = end >= stop - tiny ? stop : end;
  remember(step);
  if (end > stop + tiny) {
    inside_.evaluate(step, stop, x1);
  } else {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      std::array<double, 64> of_block{};
      matrices_[b]->end.add_product(coefficients_[b].data(), of_block.data());
      scatter(*blocks_[b].equations, of_block.data(), x1);
    }
  }
  system_.hold(x1);
  n_looks_ = 0;
  while (n_looks_ < input_degree && begin_ + (n_looks_ + 1) * interval_ < step.t1 - tiny) {
    ++n_looks_;
  }
  t_ = step.t1;
  std::copy_n(x1, x_.size(), x_.begin());
}

// Finds the remainders at the nodes. Gives the error in units of the tolerance.
double ExponentialCollocation::attempt(double interval) {
  for (int node = 0; node < n_nodes; ++node) {
    view_.forcing(begin_ + node * interval, at_node(forcing_, node, blocks_.n_forcing()));
  }
  set_sensitivities();
  predict(interval);
  prepare_states();
  double change_before = std::numeric_limits<double>::infinity();
  for (int sweeps = 0; sweeps < most_sweeps; ++sweeps) {
    find_states();
    const double change = sweep(interval);
    if (!std::isfinite(change)) break;
    const double contraction =
        sweeps == 0 ? first_contraction : std::min(0.5, change / change_before);
    change_before = change;
    if (change * contraction < settled_enough) {
      find_states();  // that belong to the latest remainders
      return interpolation_error();
    }
  }
  return std::numeric_limits<double>::infinity();
}

void ExponentialCollocation::use_rung(int rung) {
  interval_ = Propagator::length(rung);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    matrices_[b] = &blocks_[b].propagator->step(rung);
  }
}

void ExponentialCollocation::use_length(double interval) {
  interval_ = interval;
  made_to_measure_.resize(blocks_.size());
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    made_to_measure_[b] = blocks_[b].propagator->step_of(interval);
    matrices_[b] = &made_to_measure_[b];
  }
}

// By how much an error of each input, constant over the step, would change the states, in units of
// their tolerances.
void ExponentialCollocation::set_sensitivities() {
  const auto nominals = system_.nominals();
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const auto& [equations, propagator, first_constant, first_forcing, first_remainder] =
        blocks_[b];
    const Eigen::MatrixXd& gains = matrices_[b]->gains;
    const auto largest = [&](int column) {
      double largest = 0.0;
      for (int k = 0; k < gains.rows(); ++k) {
        const int state = equations->states[k];
        largest = std::max(largest, gains(k, column) / (nominals[state] + std::abs(x_[state])));
      }
      return largest / tolerance_;
    };
    const int n_f = equations->n_forcing;
    for (int i = 0; i < n_f; ++i) sensitivity_[first_forcing + i] = largest(i);
    for (int i = 0; i < equations->n_remainder; ++i) {
      sensitivity_[blocks_.n_forcing() + first_remainder + i] = largest(n_f + i);
    }
  }
}

// Remainders at the nodes by the polynomials of the step before, moved to what is known at node 0.
void ExponentialCollocation::predict(double interval) {
  const int n = blocks_.n_remainder();
  if (!before_.known) {
    for (int node = 1; node < n_nodes; ++node) {
      std::copy_n(remainder_.begin(), n, &remainder_[node * n]);
    }
    return;
  }
  const auto& lagrange = lagrange_coefficients();
  const auto weights_at = [&](double t) {
    const double time = std::min((t - before_.begin) / before_.interval, furthest_prediction);
    std::array<double, n_nodes> weights;
    for (int l = 0; l < n_nodes; ++l) {
      weights[l] = 0.0;
      for (int q = input_degree; q >= 0; --q) weights[l] = weights[l] * time + lagrange(l, q);
    }
    return weights;
  };
  const auto now = weights_at(begin_);
  for (int node = 1; node < n_nodes; ++node) {
    const auto then = weights_at(begin_ + node * interval);
    double* of_node = at_node(remainder_, node, n);
    for (int i = 0; i < n; ++i) {
      of_node[i] = remainder_[i];
      for (int l = 0; l < n_nodes; ++l) {
        of_node[i] += (then[l] - now[l]) * before_.remainder[l * n + i];
      }
    }
  }
}

// What all sweeps have in common of the watched states at the nodes.
void ExponentialCollocation::prepare_states() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    blocks_.gather(blocks_[b], x_.data(), forcing_.data(), remainder_.data(), n_nodes,
                   coefficients_[b].data());
    const int in_sweeps = input_degree * blocks_[b].equations->n_remainder;
    const int in_common = blocks_[b].propagator->columns() - in_sweeps;
    const int rows = blocks_[b].propagator->padded_watched();
    std::ranges::fill(settled_[b], 0.0);
    for (int j = 0; j < input_degree; ++j) {
      matrices_[b]->watched[j].add_product(0, in_common, coefficients_[b].data(),
                                           &settled_[b][j * rows]);
    }
  }
}

// The watched states at the nodes, with the present remainders.
void ExponentialCollocation::find_states() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const CollocationBlocks::Block& block = blocks_[b];
    const int n_r = block.equations->n_remainder;
    const int first = block.propagator->columns() - input_degree * n_r;
    const int rows = block.propagator->padded_watched();
    double* coefficients = &coefficients_[b][first];
    for (int node = 1; node < n_nodes; ++node) {
      for (int i = 0; i < n_r; ++i) {
        *coefficients++ = remainder_[node * blocks_.n_remainder() + block.first_remainder + i];
      }
    }
    found_[b] = settled_[b];
    for (int j = 0; j < input_degree; ++j) {
      double* watched = &found_[b][j * rows];
      matrices_[b]->watched[j].add_product(first, input_degree * n_r, &coefficients_[b][first],
                                           watched);
      scatter_watched(*block.equations, watched, x_node_[j + 1].data());
    }
  }
}

// Remainders at the nodes from the states there. Gives the largest change in units of the
// tolerance.
double ExponentialCollocation::sweep(double interval) {
  const int n = blocks_.n_remainder();
  double largest = 0.0;
  for (int node = 1; node < n_nodes; ++node) {
    double* of_node = at_node(remainder_, node, n);
    view_.remainder(begin_ + node * interval, x_node_[node].data(), change_.data());
    ++work_.evaluations;
    for (int i = 0; i < n; ++i) {
      const double change =
          std::abs(change_[i] - of_node[i]) * sensitivity_[blocks_.n_forcing() + i];
      if (!(change <= largest)) largest = change;  // also if it is not a number
      of_node[i] = change_[i];
    }
  }
  return largest;
}

// The fourth difference of each input is about the error of a polynomial of one degree less.
double ExponentialCollocation::interpolation_error() const {
  constexpr std::array<double, n_nodes> weights = {1.0, -4.0, 6.0, -4.0, 1.0};
  double error = 0.0;
  const auto look_at = [&](const std::vector<double>& inputs, int n, const double* sensitivity) {
    for (int i = 0; i < n; ++i) {
      double difference = 0.0;
      for (int l = 0; l < n_nodes; ++l) difference += weights[l] * inputs[l * n + i];
      error = std::max(error, std::abs(difference) * sensitivity[i]);
    }
  };
  look_at(forcing_, blocks_.n_forcing(), sensitivity_.data());
  look_at(remainder_, blocks_.n_remainder(), &sensitivity_[blocks_.n_forcing()]);
  return error;
}

// --- what others ask for -------------------------------------------------------------------------

double ExponentialCollocation::look(int k, double* x, double* derivatives) {
  std::ranges::copy(x_node_[k + 1], x);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    std::array<double, 64> rates{};
    matrices_[b]->rates[k].add_product(coefficients_[b].data(), rates.data());
    scatter_watched(*blocks_[b].equations, rates.data(), derivatives);
  }
  return begin_ + (k + 1) * interval_;
}

void ExponentialCollocation::derivatives(double t, const double* x, double* derivatives) {
  const double* remainder = remainder_at(t, x);
  std::array<double, 64> forcing;
  view_.forcing(t, forcing.data());
  for (const CollocationBlocks::Block& block : blocks_) {
    std::array<double, 128> coefficients;
    std::array<double, 64> of_block{};
    blocks_.gather(block, x, forcing.data(), remainder, 1, coefficients.data());
    block.propagator->derivatives(coefficients.data(), of_block.data());
    scatter(*block.equations, of_block.data(), derivatives);
  }
}

// Kept, because the next step begins with it.
const double* ExponentialCollocation::remainder_at(double t, const double* x) {
  if (!(kept_.known && t == kept_.t && std::equal(kept_.x.begin(), kept_.x.end(), x))) {
    view_.remainder(t, x, kept_.remainder.data());
    ++work_.evaluations;
    kept_.known = true;
    kept_.t = t;
    std::copy_n(x, kept_.x.size(), kept_.x.begin());
  }
  return kept_.remainder.data();
}

}  // namespace manutec_r3::solver
