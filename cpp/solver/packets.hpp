// Products of small matrices with vectors, rows taken four at a time, as processors do.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace manutec_r3::solver {

inline constexpr int packet_size = 4;

inline constexpr int padded_rows(int rows) {
  return (rows + packet_size - 1) / packet_size * packet_size;
}

// A matrix whose columns are padded with zeros to whole packets.
class PacketMatrix {
 public:
  PacketMatrix() = default;
  explicit PacketMatrix(const Eigen::MatrixXd& matrix)
      : packets_(solver::padded_rows(static_cast<int>(matrix.rows())) / packet_size),
        columns_(static_cast<int>(matrix.cols())),
        entries_(packets_ * packet_size * columns_, 0.0) {
    for (int c = 0; c < columns_; ++c) {
      for (int r = 0; r < matrix.rows(); ++r) entries_[c * padded_rows() + r] = matrix(r, c);
    }
  }

  int padded_rows() const { return packets_ * packet_size; }
  int columns() const { return columns_; }

  // y (padded_rows) += columns first, first + 1, ... times the `count` coefficients.
  void add_product(int first, int count, const double* coefficients, double* y) const {
    const double* A = entries_.data() + first * padded_rows();
    switch (packets_) {
      case 1:
        return add_product<1>(A, count, coefficients, y);
      case 2:
        return add_product<2>(A, count, coefficients, y);
      case 3:
        return add_product<3>(A, count, coefficients, y);
      default:
        for (int p = 0; p < packets_; ++p) {
          add_product<1>(A + p * packet_size, count, coefficients, y + p * packet_size,
                         padded_rows());
        }
    }
  }
  void add_product(const double* coefficients, double* y) const {
    add_product(0, columns_, coefficients, y);
  }

 private:
  template <int packets>
  static void add_product(const double* A, int count, const double* coefficients, double* y,
                          int stride = packets * packet_size) {
    using Packet = Eigen::Array<double, packet_size, 1>;
    std::array<Packet, packets> sum;
    for (int p = 0; p < packets; ++p) sum[p] = Packet::Map(y + p * packet_size);
    for (int c = 0; c < count; ++c, A += stride) {
      for (int p = 0; p < packets; ++p) {
        sum[p] += Packet::Map(A + p * packet_size) * coefficients[c];
      }
    }
    for (int p = 0; p < packets; ++p) Packet::Map(y + p * packet_size) = sum[p];
  }

  int packets_ = 0;
  int columns_ = 0;
  std::vector<double> entries_;
};

}  // namespace manutec_r3::solver
