#include "solver/sundials.hpp"

#include <sundials/sundials_logger.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

namespace manutec_r3::solver {
namespace {

void keep_message(int, const char*, const char*, const char* message, SUNErrCode, void* kept,
                  SUNContext) {
  *static_cast<std::string*>(kept) = message;
}

}  // namespace

Context::Context() {
  if (SUNContext_Create(SUN_COMM_NULL, &context_) != SUN_SUCCESS) throw std::bad_alloc();
  SUNContext_ClearErrHandlers(context_);
  SUNContext_PushErrHandler(context_, keep_message, &message_);
  // Warnings have a channel of their own, which would be printed.
  SUNLogger logger = nullptr;
  SUNContext_GetLogger(context_, &logger);
  SUNLogger_SetWarningFilename(logger, "");
}

Context::~Context() { SUNContext_Free(&context_); }

RightHandSide::RightHandSide(hybrid::System& system)
    : system_(system), kept_x_(system.n_states()), kept_derivatives_(system.n_states()) {}

int RightHandSide::call(sunrealtype t, N_Vector x, N_Vector derivatives, void* self) {
  RightHandSide& f = *static_cast<RightHandSide*>(self);
  try {
    f.evaluate(t, N_VGetArrayPointer(x), N_VGetArrayPointer(derivatives));
    return 0;
  } catch (...) {
    f.thrown_ = std::current_exception();
    return -1;  // unrecoverable
  }
}

void RightHandSide::evaluate(double t, const double* x, double* derivatives) {
  // Bit by bit, which is faster than number by number.
  if (kept_ && t == kept_t_ &&
      std::memcmp(kept_x_.data(), x, kept_x_.size() * sizeof(double)) == 0) {
    std::copy(kept_derivatives_.begin(), kept_derivatives_.end(), derivatives);
    return;
  }
  ++evaluations_;
  system_.derivatives(t, x, derivatives);
}

void RightHandSide::evaluate_and_keep(double t, const double* x, double* derivatives) {
  evaluate(t, x, derivatives);
  kept_t_ = t;
  std::copy_n(x, kept_x_.size(), kept_x_.begin());
  std::copy_n(derivatives, kept_derivatives_.size(), kept_derivatives_.begin());
  kept_ = true;
}

void RightHandSide::rethrow() {
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void set_absolute_tolerances(const hybrid::System& system, double relative, Vector& absolute) {
  std::ranges::transform(system.nominals(), absolute.data(),
                         [relative](double nominal) { return relative * nominal; });
}

}  // namespace manutec_r3::solver
