#pragma once

#include <frontlux/export.hpp>
#include <frontlux/thread_sanitizer.hpp>

#include <algorithm>
#include <cstddef>

namespace frontlux {
namespace detail {

FRONTLUX_EXPORT void run_ranges(std::size_t size, const void* work,
                                void (*call)(const void* work, std::size_t begin, std::size_t end));
FRONTLUX_EXPORT void isolate(const void* work, void (*call)(const void* work));

}  // namespace detail

/// Calls `work(begin, end)` for ranges that make up [0, size), on the threads of TBB's current task arena;
/// for as few as keep the threads busy. Numbers are rounded to the nearest in there, whatever the caller's
/// mode. All of it is done unless `work` throws, also where the caller's own TBB group is cancelled.
template <class Work>
void for_each_range(std::size_t size, const Work& work) {
  struct Loop {
    const Work& work;
    detail::ForkAndJoin whole;
  };
  const Loop loop{work, {}};
  detail::run_ranges(size, &loop, [](const void* l, std::size_t begin, std::size_t end) {
    const auto& all = *static_cast<const Loop*>(l);
    const detail::ForkAndJoin::Part part(all.whole);
    all.work(begin, end);
  });
}

/// Calls `work(begin, end)` for the chunks of [0, size): each has `chunk` elements, the last one may have
/// fewer. Chunks run on the threads of TBB's current task arena. A single chunk runs on the calling thread,
/// so that a single query costs nothing but itself; so does an empty one. @pre chunk > 0
template <class Work>
void for_each_chunk(std::size_t size, std::size_t chunk, const Work& work) {
  if (size <= chunk) {
    work(std::size_t{0}, size);
    return;
  }
  for_each_range((size + chunk - 1) / chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i * chunk, std::min(size, (i + 1) * chunk));
  });
}

/// Calls `work(i)` for every i from 0 to `size` - 1, on the threads of TBB's current task arena.
template <class Work>
void for_each_index(std::size_t size, const Work& work) {
  for_each_chunk(size, 1, [&work](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

/// Calls `work()`. While it waits for loops inside it, this thread takes up no other work.
template <class Work>
void run_isolated(const Work& work) {
  detail::isolate(&work, [](const void* w) { (*static_cast<const Work*>(w))(); });
}

}  // namespace frontlux
