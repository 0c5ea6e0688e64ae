#pragma once

#include <cstddef>

namespace frontlux {
namespace detail {

void run_chunks(std::size_t size, std::size_t chunk, const void* work,
                void (*call)(const void* work, std::size_t begin, std::size_t end));

}  // namespace detail

/// Calls `work(begin, end)` for the chunks of [0, size): each has `chunk` elements, the last one may have
/// fewer. Chunks run on the threads of TBB's current task arena. A single chunk runs on the calling thread,
/// so that a single query costs nothing but itself.
template <class Work>
void for_each_chunk(std::size_t size, std::size_t chunk, const Work& work) {
  if (size <= chunk) {
    work(std::size_t{0}, size);
    return;
  }
  detail::run_chunks(size, chunk, &work, [](const void* w, std::size_t begin, std::size_t end) {
    (*static_cast<const Work*>(w))(begin, end);
  });
}

/// Calls `work(i)` for every i from 0 to `size` - 1, on the threads of TBB's current task arena.
template <class Work>
void for_each_index(std::size_t size, const Work& work) {
  for_each_chunk(size, 1, [&work](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

}  // namespace frontlux
