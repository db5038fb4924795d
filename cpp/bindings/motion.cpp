#include <utility>

#include "bindings/bindings.hpp"

namespace manutec_r3::bindings {
namespace {

using motion::Motion;

// Angle, rate and acceleration at each of n instants: three arrays (n, n_axes).
py::tuple evaluate(const Motion& motion, const Array& t) {
  const py::ssize_t n = t.size();
  const int n_axes = motion.n_axes();
  Array angle({n, py::ssize_t{n_axes}}), rate({n, py::ssize_t{n_axes}}),
      acceleration({n, py::ssize_t{n_axes}});
  for (py::ssize_t k = 0; k < n; ++k) {
    const int piece = motion.piece_at(t.data()[k]);
    for (int i = 0; i < n_axes; ++i) {
      const motion::Reference reference = motion.reference(piece, t.data()[k], i);
      angle.mutable_at(k, i) = reference.angle;
      rate.mutable_at(k, i) = reference.rate;
      acceleration.mutable_at(k, i) = reference.acceleration;
    }
  }
  return py::make_tuple(angle, rate, acceleration);
}

}  // namespace

void register_motion(py::module_& module) {
  py::class_<Motion, std::shared_ptr<Motion>>(module, "Motion")
      .def_property_readonly("n_axes", &Motion::n_axes)
      .def_property_readonly("duration", &Motion::duration)
      .def_property_readonly("knots", [](const Motion& motion) { return as_array(motion.knots()); })
      .def("evaluate", &evaluate);

  const auto shared = [](Motion motion) { return std::make_shared<Motion>(std::move(motion)); };
  module.def("quintic", [shared](const Array& start, const Array& end, double duration) {
    return shared(motion::quintic(as_span(start), as_span(end), duration));
  });
  module.def("trapezoid", [shared](const Array& start, const Array& end, const Array& rate,
                                   const Array& acceleration) {
    return shared(
        motion::trapezoid(as_span(start), as_span(end), as_span(rate), as_span(acceleration)));
  });
  module.def("hold", [shared](const Array& angle) { return shared(motion::hold(as_span(angle))); });
}

}  // namespace manutec_r3::bindings
