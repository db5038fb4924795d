// Products of small matrices with vectors, rows taken four at a time, as processors do.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace manutec_r3::solver {

inline constexpr int packet_size = 4;

inline constexpr int padded(int rows) {
  return (rows + packet_size - 1) / packet_size * packet_size;
}

// A matrix whose columns are padded with zeros to whole packets.
class PacketMatrix {
 public:
  PacketMatrix() = default;
  // Of zeros.
  PacketMatrix(int rows, int columns)
      : rows_(padded(rows)), columns_(columns), entries_(rows_ * columns_, 0.0) {}
  explicit PacketMatrix(const Eigen::MatrixXd& matrix)
      : PacketMatrix(static_cast<int>(matrix.rows()), static_cast<int>(matrix.cols())) {
    for (int c = 0; c < columns_; ++c) {
      for (int r = 0; r < matrix.rows(); ++r) (*this)(r, c) = matrix(r, c);
    }
  }

  int padded_rows() const { return rows_; }
  const double& operator()(int row, int column) const { return entries_[column * rows_ + row]; }
  double& operator()(int row, int column) { return entries_[column * rows_ + row]; }
  // The numbers of some columns, padding included.
  auto columns(int first, int count) {
    return Eigen::ArrayXd::Map(entries_.data() + first * rows_, count * rows_);
  }
  auto columns(int first, int count) const {
    return Eigen::ArrayXd::Map(entries_.data() + first * rows_, count * rows_);
  }

  // y = y0 + columns first, first + 1, ... times `count` coefficients; padded_rows numbers each.
  // Without y0 it is zero.
  void add_product(int first, int count, const double* coefficients, const double* y0,
                   double* y) const {
    const double* A = entries_.data() + first * rows_;
    const auto from = [y0](int row) { return y0 == nullptr ? nullptr : y0 + row; };
    int row = 0;
    for (; row + 8 * packet_size <= rows_; row += 8 * packet_size) {
      add_rows<8>(A + row, count, coefficients, from(row), y + row);
    }
    switch ((rows_ - row) / packet_size) {
      case 1:
        return add_rows<1>(A + row, count, coefficients, from(row), y + row);
      case 2:
        return add_rows<2>(A + row, count, coefficients, from(row), y + row);
      case 3:
        return add_rows<3>(A + row, count, coefficients, from(row), y + row);
      case 4:
        return add_rows<4>(A + row, count, coefficients, from(row), y + row);
      default:
        for (; row < rows_; row += packet_size) {
          add_rows<1>(A + row, count, coefficients, from(row), y + row);
        }
    }
  }
  void add_product(int first, int count, const double* coefficients, double* y) const {
    add_product(first, count, coefficients, y, y);
  }
  // y = columns 0, 1, .. times `count` coefficients.
  void product(int count, const double* coefficients, double* y) const {
    add_product(0, count, coefficients, nullptr, y);
  }
  void product(const double* coefficients, double* y) const { product(columns_, coefficients, y); }
  // The first `count` columns times a matrix of so many rows.
  PacketMatrix product(int count, const PacketMatrix& matrix) const {
    PacketMatrix result(rows_, matrix.columns_);
    for (int c = 0; c < matrix.columns_; ++c) product(count, &matrix(0, c), &result(0, c));
    return result;
  }

 private:
  // So many packets stay in registers meanwhile, if the compiler unrolls loops over them before it
  // thinks of copying memory.
  template <int packets>
  void add_rows(const double* A, int count, const double* coefficients, const double* y0,
                double* y) const {
    using Packet = Eigen::Array<double, packet_size, 1>;
    std::array<Packet, packets> sum;
    if (y0 != nullptr) {
#pragma GCC unroll 8
      for (int p = 0; p < packets; ++p) sum[p] = Packet::Map(y0 + p * packet_size);
    } else {
#pragma GCC unroll 8
      for (int p = 0; p < packets; ++p) sum[p].setZero();
    }
    for (int c = 0; c < count; ++c, A += rows_) {
#pragma GCC unroll 8
      for (int p = 0; p < packets; ++p) {
        sum[p] += Packet::Map(A + p * packet_size) * coefficients[c];
      }
    }
#pragma GCC unroll 8
    for (int p = 0; p < packets; ++p) Packet::Map(y + p * packet_size) = sum[p];
  }

  int rows_ = 0;
  int columns_ = 0;
  std::vector<double> entries_;
};

}  // namespace manutec_r3::solver
