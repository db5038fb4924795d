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

// The formula of the joint torques: the lines of its tape (operation, first operand, second
// operand, constant), whose inputs are angles, rates and accelerations, and on which line each
// torque stands.
py::tuple inverse_dynamics_tape(const Robot& robot) {
  numbers::Tape tape;
  py::list torques;
  std::visit(
      [&]<int N>(const arm::Mechanism<N>& mechanism) {
        std::array<arm::Vector<N, numbers::Recorded>, 3> inputs;  // q, qd, qdd
        for (auto& of_axes : inputs) {
          for (auto& number : of_axes) number = tape.input();
        }
        const auto& [q, qd, qdd] = inputs;
        for (const auto& torque : arm::inverse_dynamics(mechanism, q, qd, qdd)) {
          torques.append(tape.place_of(torque));
        }
      },
      robot.arm());
  py::list lines;
  for (const numbers::Tape::Line& line : tape.lines()) {
    lines.append(
        py::make_tuple(numbers::name_of(line.operation), line.first, line.second, line.constant));
  }
  return py::make_tuple(lines, torques);
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
  module.def("inverse_dynamics_tape", &inverse_dynamics_tape);
  module.def("mass_matrix", &mass_matrix);
  module.def("link_poses", &link_poses);
}

}  // namespace manutec_r3::bindings
