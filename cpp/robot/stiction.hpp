// Which of the axes that are at zero rate stick (spec 5.3).
//
// With the friction torques r (motor side) of the resting axes, their accelerations are
//
//   a = a0 - W (p r),   W the rows and columns of M^-1 that belong to them.
//
// A combination of sticking and sliding axes agrees with physics if sticking ones (a = 0) stay
// within their limit, |r| <= rM_h, and sliding ones (r = s rM_1) accelerate in the direction s of
// their rotors that their friction opposes. A consistent combination always exists; if rM_h > rM_1
// there may be several. The rule: most sticking axes; then most of those that stick already; then
// the lexicographically first, sticking before -1 before +1, axis 1 first.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace manutec_r3::robot {

// For each resting axis, at most six.
using RestingVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
using RestingMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

// An axis is a joint with a rigid gear, or the rotor (p = 1) behind an elastic one.
struct RestingAxes {
  RestingMatrix W;             // [1/(kg m^2)], joint side
  RestingVector a0;            // [rad/s^2], joint side
  RestingVector p;             // gear ratios
  RestingVector rM_h, rM_1;    // [N m], motor side; rM_h = infinity: a brake, which never slides
  std::vector<bool> sticks;    // already
  std::vector<bool> released;  // has just reached its limit: it must slide
};

// The branch of each axis. Throws SimulationFailure if there is none.
std::vector<int> consistent_branches(const RestingAxes& axes);

}  // namespace manutec_r3::robot
