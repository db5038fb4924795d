// Moments of the bodies of Table 3 (spec 3): by Steiner, J = J_c + m c c^T.
#include "arm/moments.hpp"

namespace manutec_r3::arm {

Moments moments(const Body& body) {
  Moments of_body = point_mass(body.mass, body.centre);
  // About the centre of mass, from I = trace(J) 1 - J.
  of_body.J.xx += (body.I22 + body.I33 - body.I11) / 2;
  of_body.J.yy += (body.I11 + body.I33 - body.I22) / 2;
  of_body.J.zz += (body.I11 + body.I22 - body.I33) / 2;
  of_body.J.xz -= body.I13;
  return of_body;
}

Moments point_mass(double mass, const std::array<double, 3>& position) {
  const auto [x, y, z] = position;
  const Triple h = {mass * x, mass * y, mass * z};
  return {mass, h, {h.x * x, h.y * y, h.z * z, h.x * y, h.x * z, h.y * z}};
}

Matrix<3> inertia(const Moments& body) {
  const SymmetricTensor& J = body.J;
  Matrix<3> I;
  I << J.yy + J.zz, -J.xy, -J.xz,  //
      -J.xy, J.xx + J.zz, -J.yz,   //
      -J.xz, -J.yz, J.xx + J.yy;
  return I;
}

}  // namespace manutec_r3::arm
