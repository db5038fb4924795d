// The contract of a hybrid system: smooth equations between events, branches that switch at events.
//
// The report used the neutral DSblock format so that any simulator could run its models; FMI is
// the descendant of that format, and this contract has the same shape.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace manutec_r3::hybrid {

class LinearView;

inline constexpr double never = std::numeric_limits<double>::infinity();

// What is frozen between events. The equations read it; only event handling changes it.
struct Mode {
  std::vector<std::int32_t> branches;  // of every switching element, and whatever else is discrete
  std::vector<double> held;            // values that stay constant until the next event

  bool operator==(const Mode&) const = default;
};

// A part that switches. What its kinds are the system knows; axis 0 means the whole system.
struct Element {
  int axis;
  int kind;

  auto operator<=>(const Element&) const = default;
};

// One switch of one element.
struct Change {
  Element element;
  int before;
  int after;
};

// Why the integration stopped.
struct Cause {
  std::span<const int> fired;  // indicators that have left their domain
  bool time_event;             // the instant that next_time_event() announced has come
  bool input_changed;          // somebody has set an input at this instant
};

// One run of a system: it owns its mode and all scratch memory, and nobody else uses it meanwhile.
class System {
 public:
  virtual ~System() = default;

  virtual int n_states() const = 0;
  // All that the simulation watches; may be more than the system's users are told about.
  virtual int n_indicators() const = 0;
  // Magnitude of each state: absolute tolerances are scaled by it.
  virtual std::span<const double> nominals() const = 0;

  // Whether it may have undamped oscillations much faster than what matters.
  virtual bool rings() const { return false; }

  // dx/dt at frozen branches: smooth, also a little beyond the switching points. Allocates nothing.
  virtual void derivatives(double t, const double* x, double* derivatives) = 0;

  // Sets to zero, in a state or in a derivative of it, what the present branches hold at zero: the
  // roundoff of a linear solver shall not move it.
  virtual void hold(double*) const {}

  // Positive inside the domain of the present branches. An indicator that means nothing in the
  // present branches is a positive constant.
  virtual void indicators(double t, const double* x, double* values) = 0;

  // How fast they change where the state changes with the rates dx. By a difference, unless a
  // system knows better.
  virtual void indicator_rates(double t, const double* x, const double* dx, double* rates);

  // The first instant after t at which something happens that does not depend on the state.
  virtual double next_time_event(double t) const = 0;

  // Decides the branches of a given state by physics; may move the state onto a constraint
  // (a sticking axis has the rate zero exactly).
  virtual void initialise(double t, double* x) = 0;

  // Decides the new branches by physics, for all elements concerned, in one decision. May change
  // the state. Appends what a user is to be told, in the order in which it is to be told.
  virtual void handle_event(double t, double* x, const Cause& cause, std::vector<Change>& log) = 0;

  virtual const Mode& mode() const = 0;
  virtual void set_mode(const Mode& mode) = 0;

  // Whether events of an element come as a matter of course, such as the samples of a controller:
  // they are counted, with what they cost, and listed only on request.
  virtual bool is_routine(Element) const { return false; }

  virtual Element element_of(int indicator) const = 0;
  // For messages: "friction of axis 4".
  virtual std::string describe(Element element) const = 0;

  // The same equations as linear blocks and a slow remainder, if the system knows them so.
  virtual LinearView* linear_view() { return nullptr; }

 private:
  std::vector<double> values_now_, x_soon_;
};

}  // namespace manutec_r3::hybrid
