#pragma once

#include <frontlux/thread_sanitizer.hpp>

#include <algorithm>
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
  tbb::parallel_sort(list.begin(), list.end(), less);
#endif
}

}  // namespace frontlux::detail
