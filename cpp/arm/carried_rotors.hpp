// Rotors behind elastic gears that the arms carry along (spec 6, coupling "full"): rotor j spins in
// arm j-1 about rn_j, at a rate rq'_j of its own. The arms contain the rotors frozen; what the spin
// adds is
//
//   row of joint i    sum_j rJ_j <an_i, rn_j> rq''_j + rJ_j rq'_j <an_i, w_{j-1} x rn_j>,  i < j
//   row of rotor j    rJ_j rq''_j + rJ_j (sum_i <an_i, rn_j> aq''_i + <rn_j, w'_{j-1}>)
//
// with w'_{j-1} at aq'' = 0.
#pragma once

#include "arm/mechanism.hpp"
#include "arm/vector.hpp"
#include "numbers/abreast.hpp"

namespace manutec_r3::arm {

template <int N, class Number = double>
struct CarriedRotors {
  Matrix<N, Number> projection;  // <an_i, rn_j> in row i < j, column j; 0 elsewhere
  Matrix<N, Number> swing;       // <an_i, w_{j-1} x rn_j> likewise [rad/s]
  Vector<N, Number> drift;       // <rn_j, w'_{j-1}> at aq'' = 0 [rad/s^2]
};

// Angles and rates of the joints [rad, rad/s]. The numbers are doubles, or four abreast.
template <int N, class Number>
CarriedRotors<N, Number> carried_rotors(const Mechanism<N>& mechanism, const Vector<N, Number>& q,
                                        const Vector<N, Number>& qd);

extern template CarriedRotors<1> carried_rotors(const Mechanism<1>&, const Vector<1>&,
                                                const Vector<1>&);
extern template CarriedRotors<3> carried_rotors(const Mechanism<3>&, const Vector<3>&,
                                                const Vector<3>&);
extern template CarriedRotors<6> carried_rotors(const Mechanism<6>&, const Vector<6>&,
                                                const Vector<6>&);
extern template CarriedRotors<1, numbers::Abreast> carried_rotors(
    const Mechanism<1>&, const Vector<1, numbers::Abreast>&, const Vector<1, numbers::Abreast>&);
extern template CarriedRotors<3, numbers::Abreast> carried_rotors(
    const Mechanism<3>&, const Vector<3, numbers::Abreast>&, const Vector<3, numbers::Abreast>&);
extern template CarriedRotors<6, numbers::Abreast> carried_rotors(
    const Mechanism<6>&, const Vector<6, numbers::Abreast>&, const Vector<6, numbers::Abreast>&);

}  // namespace manutec_r3::arm
