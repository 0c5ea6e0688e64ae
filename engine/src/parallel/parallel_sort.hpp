#pragma once

#include <frontlux/parallel.hpp>
#include <frontlux/thread_sanitizer.hpp>

#include <algorithm>
#include <cstddef>
#include <functional>
#ifndef FRONTLUX_THREAD_SANITIZER
#include <tbb/parallel_sort.h>
#endif

namespace frontlux::detail {

/// Sorts on the threads of TBB's current task arena. On one thread under the thread sanitizer, which does not
/// see how TBB's sort hands elements from thread to thread.
template <class List, class Less = std::less<>>
void parallel_sort(List& list, const Less& less = {}) {
#ifdef FRONTLUX_THREAD_SANITIZER
  std::sort(list.begin(), list.end(), less);
#else
  // In a group of its own, which nobody cancels.
  for_each_range(1, [&](std::size_t, std::size_t) { tbb::parallel_sort(list.begin(), list.end(), less); });
#endif
}

}  // namespace frontlux::detail
