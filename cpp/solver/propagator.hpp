// The exact solution of a linear block (hybrid/linear_view.hpp) whose inputs are polynomials in
// time:
//
//   x' = L x + B u,    x(d) = x(0) + F x(0) + sum_q V_q u^(q)(0)
//
//   F = exp(L d) - 1,  V_q = int_0^d exp(L (d - tau)) B tau^q/q! dtau
//
// (of exp(L d) itself, every doubling of d would double the roundoff of what is almost 1)
//
// for lengths d of a ladder, each half of the one above, and for steps of four such intervals with
// inputs that are known at their five ends, the nodes.
//
// The columns of all matrices are for: states at the beginning; constants; forcing; remainder. Of
// forcing and remainder there are as many columns as nodes, or as orders q of derivatives.
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "hybrid/linear_view.hpp"
#include "solver/packets.hpp"

namespace manutec_r3::solver {

// Of the polynomials; a step has as many intervals, and one node more.
inline constexpr int input_degree = 4;
inline constexpr int n_nodes = input_degree + 1;
// All but the first are looked at together.
static_assert(input_degree == packet_size);

// States, and columns, that a block may have.
inline constexpr int most_states = 16;
inline constexpr int most_columns = 48;
// The states of a block, and the watched ones at nodes 1 to 4, with room for all rows that a
// product may take at once.
using BlockState = std::array<double, 8 * packet_size>;
using BlockAtNodes = std::array<double, input_degree * most_states>;
static_assert(most_states <= 8 * packet_size);

// Coefficients of Lagrange's polynomials for the nodes 0, 1, .., 4: row l, power q.
const Eigen::Matrix<double, n_nodes, n_nodes>& lagrange_coefficients();
// Their slopes at the nodes: row l, node k.
const Eigen::Matrix<double, n_nodes, n_nodes>& lagrange_slopes();

// The matrices of a step, for inputs at the nodes.
struct StepMatrices {
  PacketMatrix watched;  // each watched state at nodes 1 to 4, then the next
  PacketMatrix rates;    // their derivatives likewise
  PacketMatrix end;      // all states at node 4
  // By how much constant forcing and remainder change states over the step; zero beyond them.
  Eigen::Array<double, most_states, Eigen::Dynamic> gains;
};

class Propagator {
 public:
  explicit Propagator(hybrid::LinearBlock block);
  ~Propagator();
  Propagator(const Propagator&) = delete;
  Propagator& operator=(const Propagator&) = delete;

  // The longest interval, on rung 0 [s], and how many rungs a step may go down.
  static constexpr double longest = 2e-3;
  static constexpr int lowest_rung = 40;
  static double length(int rung);

  const hybrid::LinearBlock& block() const { return block_; }
  int n_states() const { return static_cast<int>(block_.states.size()); }
  int columns() const { return columns_; }

  // The derivatives dx (padded) of the states, for inputs at the same instant: coefficients are
  // states, constants, forcing, remainder.
  void derivatives(const double* coefficients, double* dx) const {
    equations_.product(coefficients, dx);
  }

  // Of steps with intervals on this rung; made when first asked for, by any thread.
  const StepMatrices& step(int rung) const;
  // Of steps with intervals of any length [s].
  StepMatrices step_of(double interval) const;

  // Below the last rung Taylor's series takes over.
  int n_rungs() const { return static_cast<int>(exact_.size()) - n_above; }
  // The states after a length of the ladder, for derivatives of inputs at the beginning.
  void advance(int rung, const double* coefficients, double* x) const;

  // Taylor's series: terms x^(i)/i!, one every `padded_states` numbers, the states first. It has
  // all digits for times shorter than the last rung.
  static constexpr int n_terms = 9;
  int padded_states() const { return equations_.padded_rows(); }
  void expand(const double* coefficients, double* terms) const;
  // Its sum after a time.
  void sum(const double* terms, double time, double* x) const;

 private:
  // F and V_q side by side.
  using Exact = PacketMatrix;

  // Inputs of one kind: how many, the first of them among all, and their first column.
  struct Kind {
    int count, first, first_column;
    int n_orders;  // of derivatives; constants have none but themselves

    int column(int order) const { return first_column + order * count; }
  };

  // Of a step of the longest intervals.
  static constexpr int n_above = 2;

  int n_inputs() const { return static_cast<int>(block_.B.cols()); }
  Exact on_ladder(int rung) const;
  Exact brief(double length) const;
  Exact sum_of(const Exact& first, double length_of_first, const Exact& second) const;
  Exact exact(double length) const;
  PacketMatrix for_nodes(const Exact& exact, double interval) const;
  StepMatrices step_from(const Exact& one, const Exact& two, const Exact& four,
                         double length) const;

  hybrid::LinearBlock block_;
  std::array<Kind, 3> inputs_;  // constants, forcing, remainder
  int columns_;
  double fastest_;            // bound for the magnitudes of L's eigenvalues [1/s]
  PacketMatrix equations_;    // L and B
  std::vector<Exact> exact_;  // on the ladder, and two and four times its longest before
  mutable std::array<std::atomic<const StepMatrices*>, lowest_rung + 1> steps_{};
  mutable std::mutex making_;
};

// The propagator of a block, shared by all that have an equal one: the blocks of a robot recur in
// its runs, and in those of similar robots.
std::shared_ptr<const Propagator> propagator_of(const hybrid::LinearBlock& block);
// Those in use go on living.
void forget_propagators();

}  // namespace manutec_r3::solver
