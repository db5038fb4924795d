// Tables 1 to 3 as Python dictionaries, read from where the core has them.
#include <pybind11/stl.h>

#include <algorithm>
#include <array>

#include "arm/parameters.hpp"
#include "bindings/bindings.hpp"
#include "drive/parameters.hpp"

namespace manutec_r3::bindings {
namespace {

py::dict controllers_and_motors() {
  namespace d = drive;
  py::dict table;
  table["K_V"] = d::K_V;
  table["K_D"] = d::K_D;
  table["K_S"] = d::K_S;
  table["T_0"] = d::T_0;
  table["T_e"] = d::T_e;
  table["T_a"] = d::T_a;
  table["T_b"] = d::T_b;
  table["K_T"] = d::K_T;
  table["w_p"] = d::w_p;
  table["D_p"] = d::D_p;
  table["w_e"] = d::w_e;
  table["K_M"] = d::K_M;
  table["w_i"] = d::w_i;
  table["D_i"] = d::D_i;
  table["a"] = d::dead_zone_half_width;
  table["b"] = d::torque_limit;
  table["rF_max"] = d::largest_torque;
  table["rF_nom"] = d::nominal_torque;
  table["rotor_rate_max"] = d::largest_rotor_rate;
  table["p"] = d::gear_ratio;
  table["T"] = d::sampling_time;
  return table;
}

py::dict rotors_and_gears() {
  namespace d = drive;
  py::dict table;
  table["b"] = d::backlash_half_width;
  table["c"] = d::stiffness;
  table["d"] = d::damping;
  py::list sticking_limits, characteristics;
  for (const d::FrictionCharacteristic& friction : d::friction) {
    sticking_limits.append(friction.sticking_limit);
    py::list points;
    for (int k = 0; k < friction.n_points; ++k) {
      points.append(py::make_tuple(friction.points[k].rate, friction.points[k].torque));
    }
    characteristics.append(py::tuple(points));
  }
  table["rM_h"] = py::tuple(sticking_limits);
  table["friction"] = py::tuple(characteristics);
  return table;
}

py::dict as_dict(const arm::Arm& arm) {
  py::dict entry;
  entry["axis"] = arm.axis == arm::Axis::x ? "x" : "z";
  entry["offset"] = arm.offset;
  entry["mass"] = arm.body.mass;
  entry["centre_of_mass"] = arm.body.centre;
  entry["I11"] = arm.body.I11;
  entry["I22"] = arm.body.I22;
  entry["I33"] = arm.body.I33;
  entry["I13"] = arm.body.I13;
  return entry;
}

py::dict multibody() {
  py::dict table;
  py::list arms, inertias, axes;
  for (const arm::Arm& arm : arm::six_arms) arms.append(as_dict(arm));
  for (const arm::Rotor& rotor : arm::rotors) {
    inertias.append(rotor.inertia);
    axes.append(rotor.axis == arm::Axis::x ? "x" : "z");
  }
  table["arms"] = py::tuple(arms);
  table["lumped_arm_3"] = as_dict(arm::lumped_arm_3);
  table["rJ"] = py::tuple(inertias);
  table["rn"] = py::tuple(axes);
  table["joint_limits"] = arm::joint_limits;
  table["gravity"] = arm::gravity;
  table["shoulder_height"] = arm::shoulder_height;
  return table;
}

}  // namespace

void register_tables(py::module_& module) {
  module.def("parameters", [] {
    py::dict tables;
    tables["table_1"] = controllers_and_motors();
    tables["table_2"] = rotors_and_gears();
    tables["table_3"] = multibody();
    return tables;
  });
}

}  // namespace manutec_r3::bindings
