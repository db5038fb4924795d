// Sines and cosines of a few angles at once. The mathematical library computes them one by one,
// which costs as much as all the rest of the equations of motion; here the same operations serve
// all angles, and the compiler does them for two or four at a time.
//
// An angle is reduced to the nearest multiple k of pi/2 by Cody and Waite (Software Manual for the
// Elementary Functions, 1980), r = x - k pi/2 with pi/2 in three parts; the sine and the cosine of
// r, |r| <= pi/4, are the minimax polynomials of fdlibm (k_sin.c, k_cos.c; Sun Microsystems, 1993),
// whose parts of pi/2 are taken as well (e_rem_pio2.c). Without fdlibm's tail of r the result is
// within 2 units in the last place of the true value.
//
// Valid while the angles stay within `largest_reduced_angle`: beyond it, and for what is not
// finite, all of them are left to the mathematical library.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace manutec_r3::arm {

template <int n>
struct SinesAndCosines {
  std::array<double, n> sine, cosine;
};

// Joints turn by a few rad. The products of k with the parts of pi/2, of 33 bits each, are exact up
// to k = 2^20, but rounding r costs a little more the larger k is [rad].
inline constexpr double largest_reduced_angle = 1e3;

namespace reduced {

using Bits = std::uint64_t;

// a where the bits of the mask are set, b where they are not.
inline double select(Bits mask, double a, double b) {
  return std::bit_cast<double>((std::bit_cast<Bits>(a) & mask) | (std::bit_cast<Bits>(b) & ~mask));
}

// Changes the sign if bit 1 is set.
inline double negated_by_bit_1(Bits bits, double a) {
  return std::bit_cast<double>(std::bit_cast<Bits>(a) ^ ((bits & 2) << 62));
}

// sin r and cos r for |r| <= pi/4.
inline double sine(double r) {
  const double z = r * r;
  const double tail = 8.33333333332248946124e-03 +
                      z * (-1.98412698298579493134e-04 +
                           z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 +
                                                                  z * 1.58969099521155010221e-10)));
  return r + r * z * (-1.66666666666666324348e-01 + z * tail);
}

inline double cosine(double r) {
  const double z = r * r;
  const double tail =
      4.16666666666666019037e-02 +
      z * (-1.38888888888741095749e-03 +
           z * (2.48015872894767294178e-05 +
                z * (-2.75573143513906633035e-07 +
                     z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
  return (1.0 - 0.5 * z) + z * z * tail;
}

// Straight through without a branch, so that loops over it become vector operations.
inline void sine_and_cosine(double angle, double& sine_of_angle, double& cosine_of_angle) {
  constexpr double two_by_pi = 6.36619772367581382433e-01;
  constexpr double pi_by_2_part_1 = 1.57079632673412561417e+00;
  constexpr double pi_by_2_part_2 = 6.07710050630396597660e-11;
  constexpr double pi_by_2_part_3 = 2.02226624879595063154e-21;
  // Behind this number there is no room for fractions: it rounds what is added to it, and the last
  // bits of the sum are those of the integer.
  constexpr double rounds = 0x1.8p52;
  const double shifted = angle * two_by_pi + rounds;
  const Bits quadrant = std::bit_cast<Bits>(shifted);
  const double k = shifted - rounds;
  const double r = ((angle - k * pi_by_2_part_1) - k * pi_by_2_part_2) - k * pi_by_2_part_3;

  const double sine_of_r = sine(r), cosine_of_r = cosine(r);
  const Bits swapped = -(quadrant & 1);
  sine_of_angle = negated_by_bit_1(quadrant, select(swapped, cosine_of_r, sine_of_r));
  cosine_of_angle = negated_by_bit_1(quadrant + 1, select(swapped, sine_of_r, cosine_of_r));
}

}  // namespace reduced

// Angles in rad.
template <int n>
SinesAndCosines<n> sines_and_cosines(const std::array<double, n>& angles) {
  SinesAndCosines<n> result;
  double sum = 0.0;  // a bound of every angle, and not a number if one of them is none
  for (const double angle : angles) sum += std::abs(angle);
  if (sum <= largest_reduced_angle) [[likely]] {
    for (int i = 0; i < n; ++i) {
      reduced::sine_and_cosine(angles[i], result.sine[i], result.cosine[i]);
    }
  } else {
    for (int i = 0; i < n; ++i) {
      result.sine[i] = std::sin(angles[i]);
      result.cosine[i] = std::cos(angles[i]);
    }
  }
  return result;
}

}  // namespace manutec_r3::arm
