// Energies of the moving arms, each for itself (spec 3, spec 6):
//
//   kinetic     1/2 integral |v + w x r|^2 dm = m v^2 / 2 + <v, w x h> + <w, I w> / 2
//   potential   g integral z dm
//
// v: velocity of the arm's origin, w: its angular velocity. Arms contain the rotors that sit in
// them frozen, the last one contains the load.
#pragma once

#include "arm/mechanism.hpp"
#include "arm/vector.hpp"

namespace manutec_r3::arm {

template <int N>
struct ArmEnergies {
  Vector<N> kinetic;       // [J]
  Vector<N> potential;     // zero at the world's origin [J]
  Vector<N> carrier_rate;  // <rn_j, w_{j-1}>: how fast rotor j turns if it does not spin [rad/s]
};

// Angles and rates of the joints [rad, rad/s].
template <int N>
ArmEnergies<N> energies(const Mechanism<N>& mechanism, const Vector<N>& q, const Vector<N>& qd);

extern template ArmEnergies<1> energies(const Mechanism<1>&, const Vector<1>&, const Vector<1>&);
extern template ArmEnergies<3> energies(const Mechanism<3>&, const Vector<3>&, const Vector<3>&);
extern template ArmEnergies<6> energies(const Mechanism<6>&, const Vector<6>&, const Vector<6>&);

}  // namespace manutec_r3::arm
