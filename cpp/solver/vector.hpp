// Vectors of SUNDIALS with operations of our own, for an explicit step has little else to do than
// to combine its stages:
//
//   z = sum_k c_k x_k
//
// SUNDIALS goes through memory once for each term; here a block of numbers stays in registers while
// all terms are added up, in the same order on all processors.
#pragma once

#include <nvector/nvector_serial.h>

#include <span>
#include <type_traits>

namespace manutec_r3::solver {

static_assert(std::is_same_v<sunrealtype, double>, "SUNDIALS must be built in double precision");

struct Term {
  double factor;
  const double* x;
};

// Calls work<n>(first) for n numbers at a time. States come in groups of six.
template <class Work>
void in_blocks(int size, const Work& work) {
  int first = 0;
  for (; first + 12 <= size; first += 12) work.template operator()<12>(first);
  for (; first + 6 <= size; first += 6) work.template operator()<6>(first);
  for (; first < size; ++first) work.template operator()<1>(first);
}

// z (size) = sum of all terms, of which there is at least one; z may be the vector of one of them.
void combine(std::span<const Term> terms, int size, double* z);

class Vector {
 public:
  Vector(int size, SUNContext context);
  ~Vector() { N_VDestroy(vector_); }
  Vector(const Vector&) = delete;
  Vector& operator=(const Vector&) = delete;

  operator N_Vector() const { return vector_; }
  double* data() { return N_VGetArrayPointer(vector_); }

 private:
  N_Vector vector_;
};

}  // namespace manutec_r3::solver
