// A second view of a system, if it has one: blocks of states whose equations are linear, on the
// branches of the present mode, but for inputs that are slow:
//
//   x_b' = L x_b + B u_b      for the states x_b of each block
//
// What is fast belongs into L: a method that propagates the blocks exactly then takes steps as long
// as the inputs allow. Inputs u_b are of three kinds, in this order:
//
//   constants   change at events only
//   forcing     functions of time alone
//   remainder   functions of time and of the watched states of all blocks: what is left of the
//               derivatives when L, constants and forcing have had their part
#pragma once

#include <Eigen/Core>
#include <vector>

#include "numbers/abreast.hpp"

namespace manutec_r3::hybrid {

using numbers::Abreast;

struct LinearBlock {
  std::vector<int> states;   // each state of the system is in one block
  std::vector<int> watched;  // the states that remainders and indicators read, counted in the block
  Eigen::MatrixXd L, B;
  int n_constants, n_forcing, n_remainder;  // the same in all modes
};

class LinearView {
 public:
  virtual ~LinearView() = default;

  virtual int n_blocks() const = 0;
  // As it is in the present mode; it lives as long as the system and is not changed.
  virtual const LinearBlock& block(int index) = 0;

  // The inputs of all blocks, one block after another. A remainder allocates nothing.
  virtual void constants(double* values) = 0;
  virtual void forcing(double t, double* values) = 0;
  virtual void remainder(double t, const double* x, double* values) = 0;

  // The same at four instants at once, which costs little more than at one.
  virtual void forcing(const Abreast& t, Abreast* values) = 0;
  virtual void remainder(const Abreast& t, const Abreast* x, Abreast* values) = 0;
  // The system's indicators where it is known more than the watched states: remainders u, of which
  // some tell what else would be expensive.
  virtual void indicators(const Abreast& t, const Abreast* x, const Abreast* u,
                          Abreast* values) = 0;
  // How fast they change where the watched states change with the rates dx, remainders with du.
  virtual void indicator_rates(const Abreast& t, const Abreast* x, const Abreast* dx,
                               const Abreast* u, const Abreast* du, Abreast* rates) = 0;

  // Whether inputs are smooth beyond the next time event, as seen from before it.
  virtual bool extends_beyond_events() const = 0;
};

}  // namespace manutec_r3::hybrid
