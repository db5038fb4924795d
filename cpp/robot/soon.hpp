// Rates of what has no simple derivative come from a difference over a short time.
#pragma once

namespace manutec_r3::robot {

// Much shorter than any time constant, and long enough for ten digits of the difference [s].
inline constexpr double soon = 1e-7;

// Where a state x with the rates dx is by then.
inline void state_soon(const double* x, const double* dx, int n_states, double* x_soon) {
  for (int s = 0; s < n_states; ++s) x_soon[s] = x[s] + soon * dx[s];
}

}  // namespace manutec_r3::robot
