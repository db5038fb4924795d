// The simulation loop: integrates a hybrid system from event to event.
//
// Event semantics, in one place; the tests quote the numbers.
//
//  1. An indicator is positive inside the domain of the present branches. It fires at the first
//     instant of (t0, t1] at which it is zero or negative, having been positive before. A double
//     crossing within a step, out of the domain and back, is found as well, if it is deeper than
//     roundoff.
//  2. Right after an event every indicator counts as inside its domain, because the decision has
//     just been made: the same root is never searched again.
//  3. The instant is located within roundoff of t, on the method's own solution inside the step:
//     for Runge-Kutta a true step that ends there, for BDF its polynomial. The integration
//     restarts from it.
//  4. Instants closer than four units in the last place are one instant, and what happens at one
//     instant is one decision of the system.
//  5. The system may find by physics that an indicator has only touched zero. Then no branch
//     changes and nothing is logged. Neither is what happens at the start: it belongs to the
//     decision about the start.
//  6. More than 100 events of one element at one instant, or more than 1000 within 1 ms, are
//     chattering and end the run with an error that names the element.
//
// The integration may be ahead of the simulation's time by a part of a step: where a user stops to
// look does not change the steps. An event is handled when the time reaches it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "hybrid/chattering.hpp"
#include "hybrid/crossing.hpp"
#include "hybrid/integrator.hpp"
#include "hybrid/system.hpp"
#include "hybrid/trajectory.hpp"

namespace manutec_r3::hybrid {

// A change, and when it happened.
struct Event {
  double time;
  Element element;
  int before;
  int after;
};

struct Statistics {
  Work work;
  long events = 0;               // changes that were logged
  long restarts = 0;             // of the integration, after logged changes or others
  long routine_events = 0;       // among all that happened, listed or not
  long routine_evaluations = 0;  // of the derivatives, to restart where nothing else happened
  long locations = 0;            // evaluations of the solution inside a step in search of events
};

class Simulation {
 public:
  // With an event: after it has been handled; or before, and the next call handles it.
  enum class Stop { at_target, at_first_event, before_event };
  enum class Target { included, excluded };  // whether events at the target itself are handled

  enum class Routine { counted, listed };  // what becomes of events that come as a matter of course

  // Begins at (t, x): the system decides its branches. `trajectory`, if given, records the run.
  // All must outlive the simulation.
  Simulation(System& system, Integrator& integrator, double t, std::vector<double> x,
             Trajectory* trajectory = nullptr, Routine routine = Routine::counted);

  // Advances to `target`, or to the first instant with an event (if it is handled, a logged one).
  // Throws SimulationFailure.
  // `look_up` is called after every step with the time; it may throw.
  void advance(double target, Stop stop, Target at_target,
               const std::function<void(double)>& look_up = {});

  // Sets an input of the system by calling `set`: an event at the present time, branches are
  // decided again. What has been integrated ahead with the old input is given up.
  void change_input(const std::function<void()>& set);

  double time() const { return now_.time; }
  // Whether an event at the present time has not been handled yet.
  bool is_event_due() const { return now_.event && now_.time == now_.step.t1; }
  // The state at the present time, after its events.
  std::vector<double> state();
  // The events of all instants so far.
  const std::vector<Event>& events() const { return events_; }
  Statistics statistics() const;

  // What the indicators show at an instant, and their rates along the solution.
  struct Look {
    double t = 0.0;
    bool is_glance = false;  // all are far from zero, and only about so; rates are not known
    Eigen::ArrayXd z, slope;
  };

  // How far the integration has come; it may be ahead of the time.
  struct Front {
    Stretch stretch() const;
    // The next step continues the present one, or begins anew.
    void continue_step();
    void begin_step(double t);

    double time = 0.0;                              // of the simulation
    Step step;                                      // the last step, cut off at an event
    std::array<Step, Stretch::longest - 1> before;  // steps that it continues, the latest first,
    std::size_t n_before = 0;                       // so many
    std::vector<double> x;                          // state at its end
    Look look;                                      // indicators there
    bool event = false;                             // something happens at its end:
    bool time_event = false;                        // an announced instant,
    std::vector<int> fired;                         // indicators
    ChatteringGuard guard;
  };

  // All that the future depends on, the system's mode included. The log of events and the
  // statistics go on. Restoring throws std::invalid_argument if the snapshot is of another system.
  struct Snapshot {
    Front front;
    double next_size = 0.0;  // that the integrator would try
    Mode mode;
  };
  Snapshot save() const;
  void restore(const Snapshot& snapshot);

 private:
  void advance_front();
  void record_step();
  void search_step(double stop);
  void look_at_step();
  void find_near(const Look& a, const Look& b);
  double doubt_about(int indicator) const;
  void prepare(Look& look) const;
  double first_event(const Look& a, const Look& b);
  std::optional<Sample> dip(int indicator, const Sample& a, const Sample& b, double doubt,
                            int searches);
  void fold_in_simultaneous(const Look& before);
  void handle_event(bool input_changed);
  void restart(double size);
  void measure(double t, const std::vector<double>& x, Look& look);
  double indicator_inside(int indicator, double t);
  void check_indicators(const Eigen::ArrayXd& z) const;
  void check_indicator(int indicator, double z) const;

  System& system_;
  Integrator& integrator_;
  Trajectory* trajectory_;
  Routine routine_;
  double start_;
  Front now_;
  std::vector<Event> events_;
  std::vector<Change> changes_;
  std::vector<double> x0_;     // at the beginning of the step
  std::vector<Look> looks_;    // at the step, from its beginning to its end, the last
  std::size_t last_look_ = 0;  // of them
  std::vector<int> near_;      // indicators that may come near zero in the step
  Eigen::ArrayXd doubt_;       // about each of them between two looks
  Eigen::ArrayXd bound_;       // what it does not fall below
  std::vector<double> scratch_x_, scratch_z_, scratch_derivatives_, dip_x_;
  Look dip_look_;
  long restarts_ = 0;
  long routine_events_ = 0;
  long routine_evaluations_ = 0;
  long locations_ = 0;
};

}  // namespace manutec_r3::hybrid
