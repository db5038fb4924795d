#include "workers/for_each.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace manutec_r3::workers {
namespace {

// Between two looks: often enough for a person, too seldom to be noticed.
constexpr std::chrono::milliseconds look_up_interval(50);

// The tasks that nobody has taken yet, and how many are done.
class Queue {
 public:
  explicit Queue(std::size_t n_tasks) : n_tasks_(n_tasks) {}

  // What each worker does until nothing is left to be done.
  void work(const Task& task) {
    for (std::unique_lock lock(mutex_); !stop_ && next_ < n_tasks_;) {
      const std::size_t k = next_++;
      lock.unlock();
      try {
        task(k, stop_);
        lock.lock();
      } catch (...) {
        lock.lock();
        if (!thrown_) thrown_ = std::current_exception();
        stop_ = true;
      }
      ++n_done_;
      if (stop_ || n_done_ == n_tasks_) ended_.notify_all();
    }
  }

  // Until all is done, or a task has thrown.
  void watch(const std::function<void(std::size_t)>& look_up) {
    for (std::unique_lock lock(mutex_); !stop_;) {
      ended_.wait_for(lock, look_up_interval, [&] { return stop_ || n_done_ == n_tasks_; });
      const std::size_t n_done = n_done_;
      lock.unlock();
      look_up(n_done);
      if (n_done == n_tasks_) return;
      lock.lock();
    }
  }

  void stop() { stop_ = true; }
  void rethrow() {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  const std::size_t n_tasks_;
  std::mutex mutex_;  // of all below
  std::condition_variable ended_;
  std::size_t next_ = 0;
  std::size_t n_done_ = 0;
  std::atomic<bool> stop_ = false;
  std::exception_ptr thrown_;
};

}  // namespace

void for_each(std::size_t n_tasks, int n_workers, const Task& task,
              const std::function<void(std::size_t)>& look_up) {
  Queue queue(n_tasks);
  std::vector<std::thread> threads;
  const auto end = [&] {
    for (std::thread& thread : threads) thread.join();
  };
  try {
    for (int worker = 0; worker < n_workers; ++worker) {
      threads.emplace_back([&] { queue.work(task); });
    }
    queue.watch(look_up);
  } catch (...) {
    queue.stop();
    end();
    throw;
  }
  end();
  queue.rethrow();
}

}  // namespace manutec_r3::workers
