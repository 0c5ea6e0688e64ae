#include <frontlux/floating_point_mode.hpp>
#include <frontlux/parallel.hpp>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace frontlux::detail {

void run_ranges(std::size_t size, const void* work,
                void (*call)(const void* work, std::size_t begin, std::size_t end)) {
  // Whoever cancels the caller's group would end this loop before its work is done, and what it was to make
  // would be taken for complete.
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, size),
      [&](const tbb::blocked_range<std::size_t>& range) {
        // A worker has the mode of whoever started it.
        const FloatingPointMode mode(FloatingPointMode::kToNearest);
        call(work, range.begin(), range.end());
      },
      own);
}

void isolate(const void* work, void (*call)(const void* work)) {
  tbb::this_task_arena::isolate([&] { call(work); });
}

}  // namespace frontlux::detail
