#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

namespace frontlux::detail {

/// Calls `work(begin, end)` for pieces of [0, size), at most `grain` long, over the current task arena; one
/// piece runs on the calling thread alone, so that single queries cost nothing but themselves.
template <class Work>
void for_each_piece(std::size_t size, std::size_t grain, const Work& work) {
  if (size <= grain) {
    work(std::size_t{0}, size);
    return;
  }
  const std::size_t pieces = (size + grain - 1) / grain;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pieces),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t piece = range.begin(); piece < range.end(); ++piece)
                        work(piece * grain, std::min(size, (piece + 1) * grain));
                    });
}

}  // namespace frontlux::detail
