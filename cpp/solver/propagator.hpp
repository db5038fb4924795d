// The exact solution of a linear block whose inputs are polynomials in time:
//
//   x' = L x + B u,    x(d) = E x(0) + sum_q V_q u^(q)(0)
//
//   E = exp(L d),      V_q = int_0^d exp(L (d - tau)) B tau^q/q! dtau
//
// for the lengths d of a ladder, each half of the one above, and in steps of four such lengths with
// inputs that are known at their five ends, the nodes.
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

// Coefficients of Lagrange's polynomials for the nodes 0, 1, .., 4: row l, power q.
const Eigen::Matrix<double, n_nodes, n_nodes>& lagrange_coefficients();

// The matrices of a step, whose columns are for: states at its beginning, constants, forcing at the
// nodes, remainder at the nodes.
struct StepMatrices {
  std::array<PacketMatrix, input_degree> watched;  // states at nodes 1 to 4
  std::array<PacketMatrix, input_degree> rates;    // their derivatives
  PacketMatrix end;                                // all states at node 4
  Eigen::MatrixXd gains;  // by how much constant forcing and remainder change states over the step
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
  int columns() const { return columns_; }
  // Of the vectors that a step's watched states come in.
  int padded_watched() const { return padded_rows(static_cast<int>(block_.watched.size())); }

  // Of steps with intervals on this rung; made when first asked for, by any thread.
  const StepMatrices& step(int rung) const;
  // Of steps with intervals of any length [s].
  StepMatrices step_of(double interval) const;

  // The derivatives at an instant: coefficients are states, constants, forcing, remainder there.
  void derivatives(const double* coefficients, double* dx) const {
    equations_.add_product(coefficients, dx);
  }

  // Where Taylor's series takes over: below the last rung.
  int n_rungs() const { return static_cast<int>(ladder_.size()); }
  // Advances x by a length of the ladder. `coefficients` are the states, constants, derivatives of
  // forcing and of remainder from order 0 to 4, at the beginning.
  void advance(int rung, const double* coefficients, double* x) const {
    if (rung >= n_rungs()) return advance_briefly(length(rung), coefficients, x);
    ladder_[rung].add_product(coefficients, x);
  }
  // The same for any length that is shorter than the last rung's.
  void advance_briefly(double length, const double* coefficients, double* x) const;

 private:
  struct Exact;
  Exact brief(double length) const;
  Exact doubled(const Exact& half, double length_of_half) const;
  Exact exact(double length) const;
  StepMatrices step_from(const Exact& interval, double length) const;

  hybrid::LinearBlock block_;
  int columns_;
  double fastest_;          // bound for the magnitudes of L's eigenvalues [1/s]
  PacketMatrix equations_;  // L and B
  std::vector<PacketMatrix> ladder_;
  std::vector<Exact> exact_;  // on the ladder
  mutable std::array<std::atomic<const StepMatrices*>, lowest_rung + 1> steps_{};
  mutable std::mutex making_;
};

// The propagator of a block, shared by all that have an equal one: the blocks of a robot recur in
// its runs, and in those of similar robots.
std::shared_ptr<const Propagator> propagator_of(const hybrid::LinearBlock& block);

}  // namespace manutec_r3::solver
