#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "bindings/bindings.hpp"

namespace manutec_r3::bindings {
namespace {

using motion::Motion;

// A Python function of time that gives one value per axis. What it raises goes through the core to
// whoever has called that. Simulations run without the GIL: it is taken for each call.
class PythonFunction {
 public:
  PythonFunction(py::function function, std::string name, std::string unit)
      : function_(std::move(function)), name_(std::move(name)), unit_(std::move(unit)) {}

  // How many values it gives at t.
  std::size_t size(double t) const {
    const Array values = ask(t);
    if (values.ndim() == 1) return values.size();
    throw py::value_error(at(t) + ": expected 1, 3 or 6 values [" + unit_ + "], one per axis, " +
                          "got shape " + shape_of(values));
  }

  void operator()(double t, std::span<double> values) const {
    const py::gil_scoped_acquire acquire;
    const Array arrived = ask(t);
    if (arrived.ndim() != 1 || static_cast<std::size_t>(arrived.size()) != values.size()) {
      throw py::value_error(at(t) + ": expected " + std::to_string(values.size()) + " values [" +
                            unit_ + "], one per axis, got shape " + shape_of(arrived));
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = arrived.data()[i];
      if (std::isfinite(values[i])) continue;
      std::ostringstream message;
      message << at(t) << " of axis " << i + 1 << ": expected a finite value [" << unit_
              << "], got " << values[i];
      throw py::value_error(message.str());
    }
  }

 private:
  Array ask(double t) const {
    const py::object arrived = function_(t);
    const py::array array = py::array::ensure(arrived);
    if (array && std::string("iuf").find(array.dtype().kind()) != std::string::npos) {
      return Array::ensure(array);
    }
    throw py::type_error(at(t) + ": expected numbers [" + unit_ + "], one per axis, got " +
                         std::string(py::repr(arrived)));
  }

  std::string at(double t) const {
    std::ostringstream text;
    text << name_ << "(" << t << " s)";
    return text.str();
  }

  static std::string shape_of(const py::array& array) {
    return std::string(py::repr(array.attr("shape")));
  }

  py::function function_;
  std::string name_, unit_;
};

std::shared_ptr<Motion> functions(const py::function& angle, const py::function& rate,
                                  double duration, const Array& knots,
                                  const std::optional<py::function>& acceleration) {
  const PythonFunction first(angle, "angle", "rad");
  motion::Functions functions{first, PythonFunction(rate, "rate", "rad/s"), {}};
  if (acceleration) {
    functions.acceleration = PythonFunction(*acceleration, "acceleration", "rad/s^2");
  }
  return std::make_shared<Motion>(
      motion::functions(first.size(0.0), std::move(functions), duration, as_span(knots)));
}

// Angle and rate at each of n instants: two arrays (n, n_axes).
py::tuple reference(const Motion& motion, const Array& t) {
  const py::ssize_t n = t.size();
  const py::ssize_t n_axes = motion.n_axes();
  Array angle({n, n_axes}), rate({n, n_axes});
  std::vector<motion::Reference> references(n_axes);
  for (py::ssize_t k = 0; k < n; ++k) {
    const double now = t.data()[k];
    motion.reference(motion.piece_at(now), now, references);
    for (py::ssize_t i = 0; i < n_axes; ++i) {
      angle.mutable_at(k, i) = references[i].angle;
      rate.mutable_at(k, i) = references[i].rate;
    }
  }
  return py::make_tuple(angle, rate);
}

// The same for acceleration.
Array acceleration(const Motion& motion, const Array& t) {
  const std::size_t n_axes = motion.n_axes();
  Array acceleration({t.size(), static_cast<py::ssize_t>(n_axes)});
  for (py::ssize_t k = 0; k < t.size(); ++k) {
    const double now = t.data()[k];
    motion.acceleration(motion.piece_at(now), now, {acceleration.mutable_data(k), n_axes});
  }
  return acceleration;
}

}  // namespace

void register_motion(py::module_& module) {
  py::class_<Motion, std::shared_ptr<Motion>>(module, "Motion")
      .def_property_readonly("n_axes", &Motion::n_axes)
      .def_property_readonly("duration", &Motion::duration)
      .def_property_readonly("knots", [](const Motion& motion) { return as_array(motion.knots()); })
      .def("reference", &reference)
      .def("acceleration", &acceleration);

  const auto shared = [](Motion motion) { return std::make_shared<Motion>(std::move(motion)); };
  module.def("quintic", [shared](const Array& start, const Array& end, double duration) {
    return shared(motion::quintic(as_span(start), as_span(end), duration));
  });
  module.def("trapezoid", [shared](const Array& start, const Array& end, const Array& rate,
                                   const Array& acceleration) {
    return shared(
        motion::trapezoid(as_span(start), as_span(end), as_span(rate), as_span(acceleration)));
  });
  module.def("spline", [shared](const Array& times, const Array& angles) {
    return shared(motion::spline(as_span(times), as_span(angles)));
  });
  // coefficients (n, n_powers, n_axes)
  module.def("polynomials", [shared](const Array& times, const Array& coefficients) {
    return shared(motion::polynomials(as_span(times), as_span(coefficients), coefficients.shape(1),
                                      coefficients.shape(2)));
  });
  module.def("hold", [shared](const Array& angles, double duration) {
    return shared(motion::hold(as_span(angles), duration));
  });
  module.def("sequence", [shared](const std::vector<std::shared_ptr<const Motion>>& motions) {
    return shared(motion::sequence(motions));
  });
  module.def("functions", &functions);
}

}  // namespace manutec_r3::bindings
