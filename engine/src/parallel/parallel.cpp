#include <frontlux/floating_point_mode.hpp>
#include <frontlux/parallel.hpp>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace frontlux::detail {

void run_ranges(std::size_t size, const void* work,
                void (*call)(const void* work, std::size_t begin, std::size_t end)) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      // A worker has the mode of whoever started it.
                      const FloatingPointMode mode(FloatingPointMode::kToNearest);
                      call(work, range.begin(), range.end());
                    });
}

void isolate(const void* work, void (*call)(const void* work)) {
  tbb::this_task_arena::isolate([&] { call(work); });
}

}  // namespace frontlux::detail
