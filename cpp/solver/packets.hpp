// Products of small matrices with vectors, rows taken four at a time, as processors do.
#pragma once

#include <Eigen/Core>
#include <array>

#include "numbers/abreast.hpp"

namespace manutec_r3::solver {

using numbers::Abreast;

inline constexpr int packet_size = Abreast::size;

inline constexpr int padded(int rows) {
  return (rows + packet_size - 1) / packet_size * packet_size;
}

// A matrix whose columns are padded with zeros to whole packets.
class PacketMatrix {
 public:
  PacketMatrix() = default;
  // Of zeros.
  PacketMatrix(int rows, int columns)
      : rows_(padded(rows)), columns_(columns), entries_(Eigen::ArrayXd::Zero(rows_ * columns_)) {}
  explicit PacketMatrix(const Eigen::MatrixXd& matrix)
      : PacketMatrix(static_cast<int>(matrix.rows()), static_cast<int>(matrix.cols())) {
    for (int c = 0; c < columns_; ++c) {
      for (int r = 0; r < matrix.rows(); ++r) (*this)(r, c) = matrix(r, c);
    }
  }

  int padded_rows() const { return rows_; }
  const double& operator()(int row, int column) const { return entries_[column * rows_ + row]; }
  double& operator()(int row, int column) { return entries_[column * rows_ + row]; }
  // Adds so many times some columns of another matrix with as many rows.
  void add_columns(int first, int count, double times, const PacketMatrix& other, int other_first) {
    const double* from = &other(0, other_first);
    double* to = &(*this)(0, first);
    for (int i = 0; i < count * rows_; i += packet_size) {
      (Abreast::load(to + i) + times * Abreast::load(from + i)).store(to + i);
    }
  }
  PacketMatrix& operator*=(double times) {
    entries_ *= times;
    return *this;
  }

  // y = y0 + columns first, first + 1, ... times `count` coefficients; padded_rows numbers each.
  // Without y0 it is zero.
  void add_product(int first, int count, const double* coefficients, const double* y0,
                   double* y) const {
    add_product_to(first, count, coefficients, y0,
                   [y](int p, const Abreast& sum) { sum.store(y + p * packet_size); });
  }
  // y = columns 0, 1, .. times `count` coefficients.
  void product(int count, const double* coefficients, double* y) const {
    add_product(0, count, coefficients, nullptr, y);
  }
  void product(const double* coefficients, double* y) const { product(columns_, coefficients, y); }
  // The first `count` columns times a matrix of so many rows.
  PacketMatrix product(int count, const PacketMatrix& matrix) const {
    PacketMatrix result;
    result.rows_ = rows_;
    result.columns_ = matrix.columns_;
    result.entries_.resize(rows_ * matrix.columns_);
    for (int c = 0; c < matrix.columns_; ++c) product(count, &matrix(0, c), &result(0, c));
    return result;
  }

  // The same for those who take the packets of y one by one: to(packet, numbers).
  template <class To>
  void add_product_to(int first, int count, const double* coefficients, const double* y0,
                      const To& to) const {
    const double* A = entries_.data() + first * rows_;
    const int packets = rows_ / packet_size;
    int first_packet = 0;
    for (; first_packet + most_at_once < packets; first_packet += most_at_once) {
      add_rows<most_at_once, 1>(A, first_packet, count, coefficients, y0, to);
    }
    // A sum waits for the one before it: where few packets have enough columns for it to pay, even
    // and odd ones are summed up apart.
    const bool in_two_parts = count >= 8;
    switch (packets - first_packet) {
      case 1:
        return in_two_parts ? add_rows<1, 2>(A, first_packet, count, coefficients, y0, to)
                            : add_rows<1, 1>(A, first_packet, count, coefficients, y0, to);
      case 2:
        return in_two_parts ? add_rows<2, 2>(A, first_packet, count, coefficients, y0, to)
                            : add_rows<2, 1>(A, first_packet, count, coefficients, y0, to);
      case 3:
        return in_two_parts ? add_rows<3, 2>(A, first_packet, count, coefficients, y0, to)
                            : add_rows<3, 1>(A, first_packet, count, coefficients, y0, to);
      case 4:
        return in_two_parts ? add_rows<4, 2>(A, first_packet, count, coefficients, y0, to)
                            : add_rows<4, 1>(A, first_packet, count, coefficients, y0, to);
      case 5:
        return add_rows<5, 1>(A, first_packet, count, coefficients, y0, to);
      case 6:
        return add_rows<6, 1>(A, first_packet, count, coefficients, y0, to);
      case 7:
        return add_rows<7, 1>(A, first_packet, count, coefficients, y0, to);
      case 8:
        return add_rows<8, 1>(A, first_packet, count, coefficients, y0, to);
    }
  }

 private:
  // Packets that stay in registers together, if the compiler unrolls loops over them before it
  // thinks of copying memory.
  static constexpr int most_at_once = 8;

  template <int packets, int parts, class To>
  void add_rows(const double* A, int first_packet, int count, const double* coefficients,
                const double* y0, const To& to) const {
    A += first_packet * packet_size;
    const std::ptrdiff_t stride = rows_;
    Abreast sums[parts][packets];
    if (y0 != nullptr) {
#pragma GCC unroll 8
      for (int p = 0; p < packets; ++p) {
        sums[0][p] = Abreast::load(y0 + (first_packet + p) * packet_size);
      }
    }
    int c = 0;
    for (; c + parts <= count; c += parts, A += parts * stride) {
#pragma GCC unroll 2
      for (int part = 0; part < parts; ++part) {
#pragma GCC unroll 8
        for (int p = 0; p < packets; ++p) {
          sums[part][p] +=
              coefficients[c + part] * Abreast::load(A + part * stride + p * packet_size);
        }
      }
    }
    if (parts == 2 && c < count) {
#pragma GCC unroll 8
      for (int p = 0; p < packets; ++p) {
        sums[0][p] += coefficients[c] * Abreast::load(A + p * packet_size);
      }
    }
#pragma GCC unroll 8
    for (int p = 0; p < packets; ++p) {
      to(first_packet + p, parts == 2 ? sums[0][p] + sums[parts - 1][p] : sums[0][p]);
    }
  }

  int rows_ = 0;
  int columns_ = 0;
  Eigen::ArrayXd entries_;
};

}  // namespace manutec_r3::solver
