// Once a run has begun, evaluating the equations allocates nothing: every allocation of this
// program is counted.
#include <array>
#include <atomic>
#include <bit>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "check.hpp"
#include "motion/motion.hpp"
#include "robot/robot.hpp"
#include "robot/robot_system.hpp"
#include "robot/start.hpp"
#include "run.hpp"

namespace {

std::atomic<long> allocations = 0;

}  // namespace

#if defined(__SANITIZE_ADDRESS__)
// The sanitizer allocates, and tells. Its header is not everywhere.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*allocated)(const volatile void*,
                                                                           std::size_t),
                                                         void (*freed)(const volatile void*));
static const int told = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++allocations; }, [](const volatile void*) {});
#elif defined(__GLIBC__)
// Whatever allocates goes through these, operator new included.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++allocations;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}
#else
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace manutec_r3::testing {
namespace {

template <class Function>
long allocations_of(Function&& function) {
  const long before = allocations;
  function();
  return allocations - before;
}

std::unique_ptr<robot::RobotSystem> system_of(int model, robot::Controller controller,
                                              bool carried = false) {
  const std::vector<double> end = {1.0, 1.0, 0.6, -0.2, -0.15, -0.1};
  const std::size_t n = model == 1 || model == 3 ? 6 : 3;
  const std::vector<double> start(n, 0.0);
  const auto named = static_cast<robot::Model>(model);
  robot::Options options = robot::default_options(named);
  options.controller = controller;
  if (carried) options.coupling.fill(robot::Coupling::full);
  const auto robot = std::make_shared<const robot::Robot>(named, arm::Load{.mass = 15.0}, options,
                                                          robot::default_tables(named));
  const auto motion =
      std::make_shared<const motion::Motion>(motion::quintic(start, std::span(end).first(n), 1.2));
  return robot::make_system(robot, {.motion = motion});
}

TEST(AllocationsAreCounted) {
  CHECK(allocations_of([] {
          // Not a new-expression, which a compiler may leave out.
          ::operator delete(::operator new(100));
        }) > 0);
}

TEST(EquationsAndIndicatorsAllocateNothing) {
  for (int model = 1; model <= 4; ++model) {
    for (const auto controller :
         {robot::Controller::continuous, robot::Controller::sampled, robot::Controller::none}) {
      const auto system = system_of(model, controller, controller == robot::Controller::sampled);
      const int N = system->n_axes();
      std::vector<double> x(system->n_states()), dx(x.size()), z(system->n_indicators());
      // Somewhere, moving.
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.01 * static_cast<double>(i % 7) - 0.02;
      system->initialise(0.3, x.data());
      const hybrid::Mode moving = system->mode();
      // All stick, some stick, as branches of friction say.
      for (int sticking = 0; sticking < (model >= 3 ? 1 << N : 1); ++sticking) {
        hybrid::Mode mode = moving;
        int really = 0;
        for (int i = 0; i < N && model >= 3; ++i) {
          if (sticking >> i & 1) mode.branches[robot::friction * N + i] = 0;
        }
        system->set_mode(mode);
        for (int i = 0; i < N && model >= 3; ++i) really += system->branch(robot::friction, i) == 0;
        if (model >= 3) CHECK(really >= std::popcount(static_cast<unsigned>(sticking)));
        CHECK_EQUAL(allocations_of([&] { system->derivatives(0.3, x.data(), dx.data()); }), 0);
        CHECK_EQUAL(allocations_of([&] { system->indicators(0.3, x.data(), z.data()); }), 0);
      }
    }
  }
}

TEST(ReferencesAllocateNothing) {
  using motion::Motion;
  const std::vector<double> here(3, 0.0), there(3, 0.4);
  const std::vector<double> times = {0.0, 0.5, 1.0}, angles = {0, 0, 0, 1, 2, 3, 0.4, 0.4, 0.4};
  const std::vector<std::shared_ptr<const Motion>> members = {
      std::make_shared<const Motion>(motion::quintic(here, here, 0.5)),
      std::make_shared<const Motion>(motion::spline(times, angles)),
      std::make_shared<const Motion>(motion::hold(there, 0.5))};
  const Motion motion = motion::sequence(members);
  std::array<motion::Reference, 3> desired;
  for (const double t : {-0.1, 0.2, 0.7, 1.2, 1.7, 2.5}) {
    CHECK_EQUAL(allocations_of([&] { motion.reference(motion.piece_at(t), t, desired); }), 0);
  }
}

TEST(AStepBetweenEventsAllocatesOnlyForTheRecord) {
  // Without a record, a step of the Runge-Kutta method has all its memory already.
  const auto system = system_of(1, robot::Controller::none);
  const auto integrator = solver::make_integrator(Method::erk, *system, 1e-7);
  std::vector<double> x(system->n_states());
  system->initialise(0.0, x.data());
  integrator->restart(0.0, x.data(), 0.0);
  hybrid::Step step;
  for (int k = 0; k < 3; ++k) integrator->advance(hybrid::never, step, x.data());
  CHECK_EQUAL(allocations_of([&] { integrator->advance(hybrid::never, step, x.data()); }), 0);
  CHECK_EQUAL(allocations_of([&] { integrator->evaluate(step, step.t0, x.data()); }), 0);
  CHECK_EQUAL(
      allocations_of([&] { integrator->evaluate(step, 0.5 * (step.t0 + step.t1), x.data()); }), 0);
}

}  // namespace
}  // namespace manutec_r3::testing
