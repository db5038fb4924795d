#include "hybrid/system.hpp"

namespace manutec_r3::hybrid {
namespace {

// The difference is taken over this time [s]: much shorter than a step, and long enough for ten
// digits of it to survive.
constexpr double soon = 1e-7;

}  // namespace

void System::indicator_rates(double t, const double* x, const double* dx, double* rates) {
  values_now_.resize(n_indicators());
  x_soon_.resize(n_states());
  for (int s = 0; s < n_states(); ++s) x_soon_[s] = x[s] + soon * dx[s];
  indicators(t, x, values_now_.data());
  indicators(t + soon, x_soon_.data(), rates);
  for (int i = 0; i < n_indicators(); ++i) rates[i] = (rates[i] - values_now_[i]) / soon;
}

}  // namespace manutec_r3::hybrid
