// The arm alone, for many poses at once: arrays (n, n_axes) or (n, n_axes, n_axes).
#include <variant>

#include "arm/articulated.hpp"
#include "arm/composite.hpp"
#include "arm/kinematics.hpp"
#include "arm/newton_euler.hpp"
#include "bindings/bindings.hpp"
#include "robot/robot.hpp"

namespace manutec_r3::bindings {
namespace {

using robot::Robot;

// Row k of an array (n, N).
template <int N>
arm::Vector<N> row(const Array& array, py::ssize_t k) {
  return Eigen::Map<const arm::Vector<N>>(array.data() + k * N);
}

// For each k, a vector of N from vectors of N.
template <class Function>
Array per_pose(const Robot& robot, const Array& q, Function&& function) {
  Array result({q.shape(0), q.shape(1)});
  std::visit(
      [&]<int N>(const arm::Mechanism<N>& mechanism) {
        for (py::ssize_t k = 0; k < q.shape(0); ++k) {
          Eigen::Map<arm::Vector<N>>(result.mutable_data() + k * N) = function(mechanism, k);
        }
      },
      robot.arm());
  return result;
}

Array forward_dynamics(const Robot& robot, const Array& q, const Array& qd, const Array& tau) {
  return per_pose(robot, q, [&]<int N>(const arm::Mechanism<N>& mechanism, py::ssize_t k) {
    return arm::forward_dynamics<N>(mechanism, row<N>(q, k), row<N>(qd, k), row<N>(tau, k));
  });
}

Array articulated_forward_dynamics(const Robot& robot, const Array& q, const Array& qd,
                                   const Array& tau) {
  return per_pose(robot, q, [&]<int N>(const arm::Mechanism<N>& mechanism, py::ssize_t k) {
    return arm::articulated_forward_dynamics<N>(mechanism, row<N>(q, k), row<N>(qd, k),
                                                row<N>(tau, k));
  });
}

Array inverse_dynamics(const Robot& robot, const Array& q, const Array& qd, const Array& qdd) {
  return per_pose(robot, q, [&]<int N>(const arm::Mechanism<N>& mechanism, py::ssize_t k) {
    return arm::inverse_dynamics<N>(mechanism, row<N>(q, k), row<N>(qd, k), row<N>(qdd, k));
  });
}

Array mass_matrix(const Robot& robot, const Array& q) {
  Array result({q.shape(0), q.shape(1), q.shape(1)});
  std::visit(
      [&]<int N>(const arm::Mechanism<N>& mechanism) {
        for (py::ssize_t k = 0; k < q.shape(0); ++k) {
          Eigen::Map<arm::Matrix<N>>(result.mutable_data() + k * N * N) =
              arm::mass_matrix<N>(mechanism, row<N>(q, k));  // symmetric: rows are columns
        }
      },
      robot.arm());
  return result;
}

// Poses of the world and of all six arms for angles (n, 6).
Array link_poses(const Robot& robot, const Array& q) {
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  Array result({q.shape(0), py::ssize_t{7}, py::ssize_t{4}, py::ssize_t{4}});
  const arm::Table3& table = robot.tables().table_3;
  double* next = result.mutable_data();
  for (py::ssize_t k = 0; k < q.shape(0); ++k) {
    for (const Eigen::Matrix4d& pose : arm::link_poses(table, row<6>(q, k))) {
      Eigen::Map<RowMajor>{next} = pose;
      next += pose.size();
    }
  }
  return result;
}

}  // namespace

void register_arm(py::module_& module) {
  module.def("forward_dynamics", &forward_dynamics);
  module.def("articulated_forward_dynamics", &articulated_forward_dynamics);
  module.def("inverse_dynamics", &inverse_dynamics);
  module.def("mass_matrix", &mass_matrix);
  module.def("link_poses", &link_poses);
}

}  // namespace manutec_r3::bindings
