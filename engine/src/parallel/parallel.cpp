#include <frontlux/parallel.hpp>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace frontlux::detail {

void run_chunks(std::size_t size, std::size_t chunk, const void* work,
                void (*call)(const void* work, std::size_t begin, std::size_t end)) {
  const std::size_t chunks = (size + chunk - 1) / chunk;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        call(work, i * chunk, std::min(size, (i + 1) * chunk));
                    });
}

}  // namespace frontlux::detail
