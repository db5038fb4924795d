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
constexpr double settled_enough = 0.5;
constexpr int most_sweeps = 12;
// By how much a first sweep is believed to be worse than a second; after it it is known.
constexpr double first_contraction = 0.05;
// An error that even half as long a step would not mend, by far.
constexpr double hopeless = 100.0;
// Intervals twice as long make the error 2^5 times as large; some of it is left as a reserve.
constexpr double allows_twice_as_long = 0.35 / 32.0;
// Inputs that changed by less than this part of the tolerance in the step before are predicted not
// to change: their polynomials are roundoff, which extrapolation would let grow from step to step.
constexpr double negligible = 0.01;
// Polynomials of the step before are not trusted further than so many intervals beyond it.
constexpr double furthest_prediction = input_degree + 8.0;

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
      per_tolerance_(system.n_states()),
      matrices_(blocks_.size()),
      inputs_(n_nodes * blocks_.n_inputs()),
      sensitivity_(blocks_.n_inputs()),
      changes_(n_remainder()),
      scratch_inputs_(blocks_.n_inputs()),
      scratch_rates_(system.n_states()),
      of_block_(blocks_.size()),
      x_at_node_(n_nodes, std::vector<double>(system.n_states())) {
  before_.inputs.resize(inputs_.size());
  kept_.x.resize(x_.size());
  kept_.remainder.resize(n_remainder());
}

void ExponentialCollocation::restart(double t, const double* x, double size) {
  blocks_.refresh();
  inside_.mode_changed();
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
    Work& work = of_block_[b];
    work.coefficients.resize(propagator.columns());
    work.settled.resize(input_degree * propagator.padded_watched());
    work.watched.resize(work.settled.size());
    work.rates.resize(work.settled.size());
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
  std::copy_n(&step.dense[record_.inputs], before_.inputs.size(), before_.inputs.begin());
}

// --- a step --------------------------------------------------------------------------------------

void ExponentialCollocation::advance(double stop, hybrid::Step& step, double* x1) {
  begin_ = t_;
  write_record(step);  // of a step that cannot be begun at least the beginning
  std::copy_n(remainder_at(t_, x_.data()), n_remainder(), remainder_at(0));
  const auto nominals = system_.nominals();
  for (std::size_t s = 0; s < x_.size(); ++s) {
    per_tolerance_[s] = 1.0 / (tolerance_ * (nominals[s] + std::abs(x_[s])));
  }
  const double remaining = stop - t_;
  for (int rung = rung_;;) {
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
    const double error = attempt();
    if (error <= 1.0) {
      if (rung == rung_ && error < allows_twice_as_long) rung_ = std::max(rung_ - 1, 0);
      break;
    }
    ++work_.rejected_steps;
    if (rung == Propagator::lowest_rung || t_ + Propagator::length(rung) == t_) {
      rung_ = first_rung;
      throw hybrid::SimulationFailure("steps have become too short to advance the time");
    }
    rung_ = rung = std::min(rung + (error > hopeless ? 2 : 1), Propagator::lowest_rung);
  }
  ++work_.steps;
  find_rates();

  write_record(step);
  const double end = begin_ + input_degree * interval_;
  const double tiny = std::isfinite(stop) ? hybrid::simultaneous(stop) : 0.0;
  step.t1 = end >= stop - tiny ? stop : end;
  remember(step);
  if (end > stop + tiny) {
    inside_.evaluate(step, stop, x1);
  } else {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      BlockState ended;
      matrices_[b]->end.product(of_block_[b].coefficients.data(), ended.data());
      blocks_.scatter(blocks_[b], ended.data(), x1);
    }
  }
  system_.hold(x1);
  n_looks_ = 0;
  while (n_looks_ < input_degree && begin_ + (n_looks_ + 1) * interval_ < step.t1 - tiny) {
    ++n_looks_;
  }
  if (end <= stop + tiny) n_looks_ = input_degree;
  t_ = step.t1;
  std::copy_n(x1, x_.size(), x_.begin());
}

void ExponentialCollocation::write_record(hybrid::Step& step) const {
  step.t0 = begin_;
  step.dense.resize(record_.size);
  step.dense[record_.begin] = begin_;
  step.dense[record_.interval] = interval_;
  std::ranges::copy(x_, &step.dense[record_.x]);
  std::ranges::copy(inputs_, &step.dense[record_.inputs]);
}

// Finds the remainders at the nodes. Gives the error in units of the tolerance.
double ExponentialCollocation::attempt() {
  for (int node = 0; node < n_nodes; ++node) {
    view_.forcing(begin_ + node * interval_, inputs_at(node));
  }
  set_sensitivities();
  predict();
  prepare_states();
  double change_before = std::numeric_limits<double>::infinity();
  for (int sweeps = 0; sweeps < most_sweeps; ++sweeps) {
    find_states();
    const double change = sweep();
    if (!std::isfinite(change)) break;
    // Far too long a step shows it at once.
    if (sweeps == 0 && interpolation_error() > hopeless) return interpolation_error();
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
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const CollocationBlocks::Block& block = blocks_[b];
    const std::vector<int>& states = block.equations->states;
    const int n = static_cast<int>(states.size());
    BlockState per_tolerance;
    for (int k = 0; k < n; ++k) per_tolerance[k] = per_tolerance_[states[k]];
    const double* gain = matrices_[b]->gains.data();
    const auto set = [&](double& sensitivity) {
      sensitivity = 0.0;
      for (int k = 0; k < n; ++k) sensitivity = std::max(sensitivity, *gain++ * per_tolerance[k]);
    };
    for (int i = 0; i < block.equations->n_forcing; ++i) {
      set(sensitivity_[block.first_forcing + i]);
    }
    for (int i = 0; i < block.equations->n_remainder; ++i) {
      set(sensitivity_[block.first_remainder + i]);
    }
  }
}

// Remainders at the nodes by the polynomials of the step before, moved to what is known at node 0.
void ExponentialCollocation::predict() {
  const int n = n_remainder();
  const auto& lagrange = lagrange_coefficients();
  const auto weights_at = [&](double t) {
    std::array<double, n_nodes> weights{};
    if (!before_.known) return weights;
    const double time = std::min((t - before_.begin) / before_.interval, furthest_prediction);
    for (int l = 0; l < n_nodes; ++l) {
      for (int q = input_degree; q >= 0; --q) weights[l] = weights[l] * time + lagrange(l, q);
    }
    return weights;
  };
  const auto now = weights_at(begin_);
  const double* before = &before_.inputs[blocks_.n_forcing()];
  const double* sensitivity = &sensitivity_[blocks_.n_forcing()];
  for (int i = 0; i < n; ++i) {
    double change = 0.0;
    for (int l = 1; l < n_nodes; ++l) {
      change = std::max(change, std::abs(before[l * blocks_.n_inputs() + i] - before[i]));
    }
    changes_[i] = change * sensitivity[i] > negligible ? 1.0 : 0.0;
  }
  for (int node = 1; node < n_nodes; ++node) {
    const auto then = weights_at(begin_ + node * interval_);
    double* of_node = remainder_at(node);
    std::copy_n(remainder_at(0), n, of_node);
    for (int l = 0; l < n_nodes; ++l) {
      const double* of_before = before + l * blocks_.n_inputs();
      const double weight = then[l] - now[l];
      for (int i = 0; i < n; ++i) of_node[i] += changes_[i] * weight * of_before[i];
    }
  }
}

// What all sweeps have in common of the watched states at the nodes.
void ExponentialCollocation::prepare_states() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    auto& [coefficients, settled, watched, rates] = of_block_[b];
    blocks_.gather(blocks_[b], x_.data(), inputs_.data(), n_nodes, coefficients.data());
    const int in_sweeps = input_degree * blocks_[b].equations->n_remainder;
    const int in_common = blocks_[b].propagator->columns() - in_sweeps;
    matrices_[b]->watched.product(in_common, coefficients.data(), settled.data());
  }
}

// The watched states at the nodes, with the present remainders.
void ExponentialCollocation::find_states() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const CollocationBlocks::Block& block = blocks_[b];
    const int n_r = block.equations->n_remainder;
    auto& [coefficients, settled, watched, rates] = of_block_[b];
    const int first = block.propagator->columns() - input_degree * n_r;
    double* coefficient = &coefficients[first];
    for (int node = 1; node < n_nodes; ++node) {
      const double* remainder = inputs_at(node) + block.first_remainder;
      for (int i = 0; i < n_r; ++i) *coefficient++ = remainder[i];
    }
    matrices_[b]->watched.add_product(first, input_degree * n_r, &coefficients[first],
                                      settled.data(), watched.data());
    const double* value = watched.data();
    const std::size_t padding = block.propagator->padded_watched() - block.watched.size();
    for (int node = 1; node < n_nodes; ++node, value += padding) {
      double* x = x_at_node_[node].data();
      for (const int state : block.watched) x[state] = *value++;
    }
  }
}

// Remainders at the nodes from the states there. Gives the largest change in units of the
// tolerance.
double ExponentialCollocation::sweep() {
  const double* sensitivity = &sensitivity_[blocks_.n_forcing()];
  double largest = 0.0;
  for (int node = 1; node < n_nodes; ++node) {
    double* of_node = remainder_at(node);
    const double* now = scratch_inputs_.data();
    view_.remainder(begin_ + node * interval_, x_at_node_[node].data(), scratch_inputs_.data());
    ++work_.evaluations;
    for (int i = 0; i < n_remainder(); ++i) {
      const double change = std::abs(now[i] - of_node[i]) * sensitivity[i];
      if (!(change <= largest)) largest = change;  // also if it is not a number
      of_node[i] = now[i];
    }
  }
  return largest;
}

// The fourth difference of each input is about the error of a polynomial of one degree less.
double ExponentialCollocation::interpolation_error() const {
  const int n = blocks_.n_inputs();
  const double* u = inputs_.data();
  double error = 0.0;
  for (int i = 0; i < n; ++i) {
    const double difference =
        u[i] - 4.0 * u[n + i] + 6.0 * u[2 * n + i] - 4.0 * u[3 * n + i] + u[4 * n + i];
    error = std::max(error, std::abs(difference) * sensitivity_[i]);
  }
  return error;
}

void ExponentialCollocation::find_rates() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    auto& [coefficients, settled, watched, rates] = of_block_[b];
    matrices_[b]->rates.product(coefficients.data(), rates.data());
  }
}

// --- what others ask for -------------------------------------------------------------------------

double ExponentialCollocation::look(int k, double* z, double* slope) {
  const int node = k + 1, n = blocks_.n_inputs();
  const double t = node == input_degree ? t_ : begin_ + node * interval_;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const double* rate = &of_block_[b].rates[k * blocks_[b].propagator->padded_watched()];
    for (const int state : blocks_[b].watched) scratch_rates_[state] = *rate++;
  }
  std::ranges::fill(scratch_inputs_, 0.0);
  for (int l = 0; l < n_nodes; ++l) {
    const double weight = lagrange_slopes()(l, node) / interval_;
    for (int i = blocks_.n_forcing(); i < n; ++i) scratch_inputs_[i] += weight * inputs_[l * n + i];
  }
  view_.indicators(t, x_at_node_[node].data(), scratch_rates_.data(), remainder_at(node),
                   &scratch_inputs_[blocks_.n_forcing()], z, slope);
  return t;
}

void ExponentialCollocation::derivatives(double t, const double* x, double* derivatives) {
  view_.forcing(t, scratch_inputs_.data());
  std::copy_n(remainder_at(t, x), n_remainder(), &scratch_inputs_[blocks_.n_forcing()]);
  blocks_.derivatives(x, scratch_inputs_.data(), derivatives);
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
