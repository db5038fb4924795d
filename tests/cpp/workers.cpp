// Many tasks on several threads: each is done once, what goes wrong ends the work, no thread stays.
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "check.hpp"
#include "workers/for_each.hpp"

namespace manutec_r3::testing {
namespace {

using Stop = std::atomic<bool>;

const auto look_away = [](std::size_t) {};

TEST(EachTaskIsDoneOnce) {
  for (const int n_workers : {1, 2, 7}) {
    for (const std::size_t n_tasks : {0u, 1u, 1000u}) {
      std::vector<std::atomic<int>> times_done(n_tasks);
      workers::for_each(
          n_tasks, n_workers, [&](std::size_t k, const Stop&) { ++times_done[k]; }, look_away);
      for (const std::atomic<int>& times : times_done) CHECK_EQUAL(times.load(), 1);
    }
  }
}

TEST(OneWorkerKeepsTheOrder) {
  std::vector<std::size_t> order;
  workers::for_each(5, 1, [&](std::size_t k, const Stop&) { order.push_back(k); }, look_away);
  CHECK((order == std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

TEST(TwoWorkersWorkAtTheSameTime) {
  // Each task waits for the other: one after the other they would never end.
  std::atomic<int> n_begun = 0;
  workers::for_each(
      2, 2,
      [&](std::size_t, const Stop&) {
        for (++n_begun; n_begun < 2;) std::this_thread::yield();
      },
      look_away);
  CHECK_EQUAL(n_begun.load(), 2);
}

TEST(ThreadsAreOthersThanTheOneThatLooks) {
  std::mutex mutex;
  std::set<std::thread::id> at_work, looking;
  workers::for_each(
      100, 3,
      [&](std::size_t, const Stop&) {
        const std::lock_guard lock(mutex);
        at_work.insert(std::this_thread::get_id());
      },
      [&](std::size_t) { looking.insert(std::this_thread::get_id()); });
  CHECK((looking == std::set{std::this_thread::get_id()}));
  CHECK(at_work.size() <= 3);
  CHECK(!at_work.contains(std::this_thread::get_id()));
}

TEST(TheLastLookSeesAllTasksDone) {
  std::size_t seen = 0;
  workers::for_each(20, 2, [](std::size_t, const Stop&) {}, [&](std::size_t n) { seen = n; });
  CHECK_EQUAL(seen, 20u);
}

TEST(WhatALookThrowsEndsTheWork) {
  std::atomic<int> n_begun = 0;
  std::atomic<int> n_ended = 0;
  const auto until_stopped = [&](std::size_t, const Stop& stop) {
    for (++n_begun; !stop;) std::this_thread::yield();
    ++n_ended;
  };
  const auto look = [](std::size_t) { throw std::runtime_error("enough"); };
  const std::string said =
      CHECK_THROWS(workers::for_each(100, 2, until_stopped, look), std::runtime_error);
  CHECK_EQUAL(said, "enough");
  CHECK(n_begun <= 2);
  CHECK_EQUAL(n_ended.load(), n_begun.load());  // nobody is still at it
}

TEST(WhatATaskThrowsEndsTheWork) {
  std::atomic<int> n_begun = 0;
  const auto task = [&](std::size_t k, const Stop& stop) {
    ++n_begun;
    if (k == 3) throw std::runtime_error("task 3");
    while (k > 3 && !stop) std::this_thread::yield();
  };
  const std::string said =
      CHECK_THROWS(workers::for_each(100, 2, task, look_away), std::runtime_error);
  CHECK_EQUAL(said, "task 3");
  CHECK(n_begun <= 5);
}

}  // namespace
}  // namespace manutec_r3::testing
