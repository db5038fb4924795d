#include "solver/exponential_collocation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
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
// What a sweep leaves of the changes that the one before has made is about the part that the
// interval is of this [s]; after two sweeps it is known.
constexpr double no_contraction = 8e-3;
// Intervals twice as long make the error so many times as large.
constexpr double per_doubling = 32.0;
// An error that half as long a step would not mend: it does not fall as much as it grows.
constexpr double twice_too_long = 10.0;
// An error after the first sweep that others would not mend.
constexpr double hopeless = 2.0;
// Some of the tolerance is left as a reserve, and for what sweeps have left.
constexpr double acceptable = 0.75;
constexpr double allows_twice_as_long = 0.35 * acceptable / per_doubling;
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
      inside_(blocks_),
      x_(system.n_states()),
      matrices_(blocks_.size()),
      coefficients_(blocks_.n_coefficients() + most_states),
      nominals_(blocks_.size(), OfStates::Constant(std::numeric_limits<double>::infinity())),
      by_tolerance_(blocks_.size(), OfStates::Zero()),
      sensitivity_to_forcing_(blocks_.forcing().size()),
      sensitivity_to_remainder_(blocks_.remainder().size()),
      settled_(blocks_.size()),
      no_slopes_(system.n_indicators(), 0.0),
      scratch_forcing_(blocks_.forcing().size()) {
  at_nodes_.forcing.resize(blocks_.forcing().size());
  at_nodes_.x.resize(system.n_states());
  at_nodes_.dx.resize(system.n_states());
  at_nodes_.u.resize(blocks_.remainder().size());
  at_nodes_.du.resize(blocks_.remainder().size());
  at_nodes_.z.resize(system.n_indicators());
  at_nodes_.dz.resize(system.n_indicators());
  before_.coefficients.resize(blocks_.n_coefficients());
  kept_.x.resize(x_.size());
  kept_.remainder.resize(blocks_.remainder().size());
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const std::vector<int>& states = blocks_[b].states;
    for (std::size_t s = 0; s < states.size(); ++s) {
      nominals_[b][s] = system.nominals()[states[s]];
    }
  }
}

void ExponentialCollocation::mode_changed() {
  blocks_.refresh();
  inside_.mode_changed();
}

void ExponentialCollocation::restart(double t, const double* x, double size) {
  mode_changed();
  blocks_.set_constants(coefficients_.data());
  t_ = t;
  std::copy_n(x, x_.size(), x_.begin());
  kept_.known = continues_ = false;
  n_looks_ = 0;
  rung_ = first_rung;
  if (size > 0.0) {
    const double halvings = std::log2(input_degree * Propagator::longest / size);
    rung_ = std::clamp(static_cast<int>(std::lround(halvings)), 0, Propagator::lowest_rung);
  }
}

double ExponentialCollocation::next_size() const {
  return input_degree * Propagator::length(rung_);
}

void ExponentialCollocation::remember(const hybrid::Step& step) {
  before_.known = static_cast<int>(step.dense.size()) == CollocationRecord::size(blocks_);
  if (!before_.known) return;
  before_.begin = step.dense[CollocationRecord::begin];
  before_.interval = step.dense[CollocationRecord::interval];
  std::copy_n(&step.dense[CollocationRecord::coefficients], before_.coefficients.size(),
              before_.coefficients.begin());
}

// --- a step --------------------------------------------------------------------------------------

void ExponentialCollocation::advance(double stop, hybrid::Step& step, double* x1) {
  begin_ = t_;
  blocks_.set_states(x_.data(), coefficients_.data());
  try {
    find_step(stop);
  } catch (...) {
    write_record(step);  // at least the beginning
    throw;
  }
  ++work_.steps;

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
      matrices_[b]->end.product(&coefficients_[blocks_[b].first_state], ended.data());
      blocks_.scatter(blocks_[b], ended.data(), x1);
    }
  }
  system_.hold(x1);
  n_looks_ = 0;
  while (n_looks_ < input_degree && begin_ + (n_looks_ + 1) * interval_ < step.t1 - tiny) {
    ++n_looks_;
  }
  if (end <= stop + tiny) n_looks_ = input_degree;
  continues_ = end < stop - tiny;
  t_ = step.t1;
  std::copy_n(x1, x_.size(), x_.begin());
}

// What is not known at the nodes, in an interval that is short enough.
void ExponentialCollocation::find_step(double stop) {
  const double* remainder = remainder_at(t_, x_.data());
  for (const Input& input : blocks_.remainder()) coefficients_[input.at(0)] = *remainder++;
  const double* forcing = scratch_forcing_.data();
  if (!continues_) view_.forcing(t_, scratch_forcing_.data());
  for (const Input& input : blocks_.forcing()) {
    coefficients_[input.at(0)] = continues_ ? coefficients_[input.at(input_degree)] : *forcing++;
  }
  continues_ = false;
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
    if (error <= acceptable) {
      if (rung == rung_ && error < allows_twice_as_long) rung_ = std::max(rung_ - 1, 0);
      break;
    }
    ++work_.rejected_steps;
    if (rung == Propagator::lowest_rung || t_ + Propagator::length(rung) == t_) {
      rung_ = first_rung;
      throw hybrid::SimulationFailure("steps have become too short to advance the time");
    }
    rung_ = rung = std::min(rung + (error > twice_too_long ? 2 : 1), Propagator::lowest_rung);
  }
}

void ExponentialCollocation::write_record(hybrid::Step& step) const {
  step.t0 = begin_;
  step.dense.resize(CollocationRecord::size(blocks_));
  step.dense[CollocationRecord::begin] = begin_;
  step.dense[CollocationRecord::interval] = interval_;
  std::copy_n(coefficients_.begin(), blocks_.n_coefficients(),
              &step.dense[CollocationRecord::coefficients]);
}

// Finds the remainders at the nodes. Gives the error in units of the tolerance.
double ExponentialCollocation::attempt() {
  set_forcing();
  set_sensitivities();
  predict();
  prepare_states();
  double change_before = std::numeric_limits<double>::infinity();
  for (int sweeps = 0; sweeps < most_sweeps; ++sweeps) {
    find_states();
    const double change = sweep();
    if (!std::isfinite(change)) break;
    // Too long a step shows it at once.
    if (sweeps == 0) {
      const double error = interpolation_error();
      if (error > hopeless) return error;
    }
    const double contraction =
        sweeps == 0 ? interval_ / no_contraction : std::min(0.5, change / change_before);
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

// At node 0 it is known.
void ExponentialCollocation::set_forcing() {
  for (int k = 0; k < input_degree; ++k) at_nodes_.t[k] = begin_ + (k + 1) * interval_;
  view_.forcing(at_nodes_.t, at_nodes_.forcing.data());
  for (std::size_t i = 0; i < blocks_.forcing().size(); ++i) {
    const Input& input = blocks_.forcing()[i];
    for (int k = 0; k < input_degree; ++k) {
      coefficients_[input.at(k + 1)] = at_nodes_.forcing[i][k];
    }
  }
}

// By how much an error of each input, constant over the step, would change the states, in units of
// their tolerances.
void ExponentialCollocation::set_sensitivities() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const auto x = OfStates::Map(&coefficients_[blocks_[b].first_state]);
    by_tolerance_[b] = (tolerance_ * (nominals_[b] + x.abs())).inverse();
  }
  const auto sensitivity_to = [&](const Input& input) {
    const auto gain = matrices_[input.block]->gains.col(input.place_in_block);
    return (gain * by_tolerance_[input.block]).maxCoeff();
  };
  std::ranges::transform(blocks_.forcing(), sensitivity_to_forcing_.begin(), sensitivity_to);
  std::ranges::transform(blocks_.remainder(), sensitivity_to_remainder_.begin(), sensitivity_to);
}

// Remainders at the nodes by the polynomials of the step before, moved to what is known at node 0.
void ExponentialCollocation::predict() {
  // By how much a value at each node of the step before raises those at nodes 1 to 4 of this one
  // above the one at node 0.
  const auto& lagrange = lagrange_coefficients();
  const auto time = [&](const auto& t) {
    return min((t - before_.begin) / before_.interval, furthest_prediction);
  };
  const Abreast at_nodes = time(at_nodes_.t), at_begin = time(Abreast(begin_));
  std::array<Abreast, n_nodes> weights;
  for (int l = 0; l < n_nodes; ++l) {
    Abreast here = lagrange(l, input_degree), before = here;
    for (int q = input_degree - 1; q >= 0; --q) {
      here = here * at_nodes + lagrange(l, q);
      before = before * at_begin + lagrange(l, q);
    }
    weights[l] = here - before;
  }

  for (std::size_t i = 0; i < blocks_.remainder().size(); ++i) {
    const Input& input = blocks_.remainder()[i];
    const double first = before_.coefficients[input.at(0)];
    double change = 0.0;
    Abreast rise;
    for (int l = 1; l < n_nodes; ++l) {
      // From the first on: weights of a constant add up to nothing.
      const double from_first = before_.coefficients[input.at(l)] - first;
      change = std::max(change, std::abs(from_first));
      rise += from_first * weights[l];
    }
    if (!before_.known || !(change * sensitivity_to_remainder_[i] > negligible)) rise = 0.0;
    const double now = coefficients_[input.at(0)];
    for (int k = 0; k < input_degree; ++k) coefficients_[input.at(k + 1)] = now + rise[k];
  }
}

// What all sweeps have in common of the watched states at the nodes.
void ExponentialCollocation::prepare_states() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    const int in_common = block.first_remainder + block.n_remainder - block.first_state;
    matrices_[b]->watched.product(in_common, &coefficients_[block.first_state], settled_[b].data());
  }
}

// The watched states at the nodes, with the present remainders.
void ExponentialCollocation::find_states() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    const int at_node_1 = block.first_remainder + block.n_remainder;
    matrices_[b]->watched.add_product_to(
        at_node_1 - block.first_state, input_degree * block.n_remainder, &coefficients_[at_node_1],
        settled_[b].data(), [&](int w, const Abreast& x) { at_nodes_.x[block.watched[w]] = x; });
  }
}

// Remainders at the nodes from the states there. Gives the largest change in units of the
// tolerance.
double ExponentialCollocation::sweep() {
  view_.remainder(at_nodes_.t, at_nodes_.x.data(), at_nodes_.u.data());
  work_.evaluations += input_degree;
  double largest = 0.0;
  for (std::size_t i = 0; i < blocks_.remainder().size(); ++i) {
    const Input& input = blocks_.remainder()[i];
    for (int k = 0; k < input_degree; ++k) {
      double& value = coefficients_[input.at(k + 1)];
      const double now = at_nodes_.u[i][k];
      const double change = std::abs(now - value) * sensitivity_to_remainder_[i];
      if (!(change <= largest)) largest = change;  // also if it is not a number
      value = now;
    }
  }
  return largest;
}

// The fourth difference of each input is about the error of a polynomial of one degree less.
double ExponentialCollocation::interpolation_error() const {
  double error = 0.0;
  const auto compare = [&](const std::vector<Input>& inputs, const double* sensitivity) {
    for (const Input& input : inputs) {
      const auto u = [&](int node) { return coefficients_[input.at(node)]; };
      const double difference = u(0) - 4.0 * u(1) + 6.0 * u(2) - 4.0 * u(3) + u(4);
      error = std::max(error, std::abs(difference) * *sensitivity++);
    }
  };
  compare(blocks_.forcing(), sensitivity_to_forcing_.data());
  compare(blocks_.remainder(), sensitivity_to_remainder_.data());
  return error;
}

// --- what others ask for -------------------------------------------------------------------------

bool ExponentialCollocation::glance(const double* z0, const double* slope0, double* z1,
                                    std::vector<int>& near) {
  view_.indicators(at_nodes_.t, at_nodes_.x.data(), at_nodes_.u.data(), at_nodes_.z.data());
  const std::span<const Abreast> at_nodes = at_nodes_.z;
  if (slope0 == nullptr) slope0 = no_slopes_.data();
  const double third = interval_ / 3.0;
  for (std::size_t i = 0; i < at_nodes.size(); ++i) {
    const Abreast& z = at_nodes[i];
    const double move = third * slope0[i];
    z1[i] = z[input_degree - 1];
    // Most move by less than a third, which is enough.
    if (max(abs(z - z0[i]), std::abs(move)).largest() < 1.0 / 3.0 * z0[i]) continue;
    const double low = std::min({z0[i], z0[i] + move, z.smallest()});
    const double high = std::max({z0[i], z0[i] + move, z.largest()});
    if (!(low > high - low)) near.push_back(static_cast<int>(i));  // also if it is not a number
  }
  return true;
}

double ExponentialCollocation::look(int k, double* z, double* slope) {
  if (k == 0) look_at_nodes();
  for (std::size_t i = 0; i < at_nodes_.z.size(); ++i) {
    z[i] = at_nodes_.z[i][k];
    slope[i] = at_nodes_.dz[i][k];
  }
  return k + 1 == input_degree ? t_ : at_nodes_.t[k];
}

void ExponentialCollocation::look_at_nodes() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    matrices_[b]->rates.add_product_to(
        0, block.columns(), &coefficients_[block.first_state], nullptr,
        [&](int w, const Abreast& rate) { at_nodes_.dx[block.watched[w]] = rate; });
  }
  const Eigen::Matrix<double, input_degree, n_nodes> slopes =
      lagrange_slopes().rightCols<input_degree>().transpose() / interval_;
  for (std::size_t i = 0; i < blocks_.remainder().size(); ++i) {
    const Input& input = blocks_.remainder()[i];
    at_nodes_.du[i] = 0.0;
    for (int l = 0; l < n_nodes; ++l) {
      at_nodes_.du[i] += coefficients_[input.at(l)] * Abreast::load(slopes.col(l).data());
    }
  }
  view_.indicator_rates(at_nodes_.t, at_nodes_.x.data(), at_nodes_.dx.data(), at_nodes_.u.data(),
                        at_nodes_.du.data(), at_nodes_.dz.data());
}

void ExponentialCollocation::derivatives(double t, const double* x, double* derivatives) {
  view_.forcing(t, scratch_forcing_.data());
  blocks_.derivatives(x, scratch_forcing_.data(), remainder_at(t, x), derivatives);
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
