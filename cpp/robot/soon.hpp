// Rates of what has no simple derivative come from a difference over a short time.
#pragma once

namespace manutec_r3::robot {

// Much shorter than any time constant, and long enough for ten digits of the difference [s].
inline constexpr double soon = 1e-7;

// Where a state x with the rates dx is by then.
template <class Number>
void state_soon(const Number* x, const Number* dx, int n_states, Number* x_soon) {
  for (int s = 0; s < n_states; ++s) x_soon[s] = x[s] + soon * dx[s];
}

}  // namespace manutec_r3::robot
