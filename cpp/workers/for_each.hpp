// Many tasks that do not depend on each other, on several threads. What a task does it knows
// itself.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace manutec_r3::workers {

// Does task number k. A long one looks at `stop` now and then, and ends early once it is true.
using Task = std::function<void(std::size_t k, const std::atomic<bool>& stop)>;

// Does each of the tasks 0 to n_tasks - 1 once, in this order, as many at a time as there are
// workers. Meanwhile `look_up` is called in the calling thread, with the number of tasks done,
// about every 50 ms and once all are done.
//
// What `look_up` or a task throws ends the work: no further task begins, those that have begun are
// told to stop. It is thrown here after the last of them has ended, so that no thread is left.
void for_each(std::size_t n_tasks, int n_workers, const Task& task,
              const std::function<void(std::size_t n_done)>& look_up);

}  // namespace manutec_r3::workers
