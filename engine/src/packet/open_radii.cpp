#include "packet/open_radii.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace frontlux::detail {
namespace {

// A set of cells, a bit each, in rows along x.
struct Cells {
  std::size_t row_words, rows, layers;  // along x, y, z
  std::vector<std::uint64_t> words;

  Cells(std::size_t x, std::size_t y, std::size_t z)
      : row_words((x + 63) / 64), rows(y), layers(z), words(row_words * rows * layers) {}
  [[nodiscard]] std::uint64_t* row(std::size_t y, std::size_t z) {
    return &words[(z * rows + y) * row_words];
  }
};

// Whether each of a brick's 2 x 2 x 2 cells holds a closed voxel: a row of two cells in the low bits of each
// byte, y first.
std::uint32_t closed_cells(const std::uint64_t* brick) {
  std::uint32_t closed = 0;
  for (unsigned z = 0; z < 2; ++z) {
    const std::uint64_t layers = ~(brick[4 * z] & brick[4 * z + 1] & brick[4 * z + 2] & brick[4 * z + 3]);
    constexpr std::uint64_t kCell = 0x0F0F'0F0F;
    for (unsigned y = 0; y < 2; ++y)
      for (unsigned x = 0; x < 2; ++x)
        closed |= (layers & kCell << (4 * x + 32 * y)) != 0 ? 1U << (x + 8 * y + 16 * z) : 0U;
  }
  return closed;
}

// The same of a brick whose radii are known: they are 0.
std::uint32_t closed_cells(std::uint32_t radii) {
  const std::uint32_t open = (radii | radii >> 1 | radii >> 2 | radii >> 3) & 0x1111'1111U;
  return ~(open | open >> 3) & 0x0303'0303U;
}

// Layers for a thread to go through at a time: to wake up another one takes longer than some thousand of the
// words, or bricks, in a layer.
std::size_t layers_at_a_time(std::size_t in_layer) {
  constexpr std::size_t kWorthAThread = 8192;
  return std::max<std::size_t>(kWorthAThread / std::max<std::size_t>(in_layer, 1), 1);
}

// Adds to a set all neighbours, over faces, edges and corners, of what it holds.
void grow(Cells& cells, Cells& scratch) {
  const std::size_t width = cells.row_words, layer = width * cells.rows;
  for_each_chunk(cells.layers, layers_at_a_time(layer), [&](std::size_t begin, std::size_t end) {
    for (std::size_t z = begin; z < end; ++z) {
      for (std::size_t y = 0; y < cells.rows; ++y) {  // along x
        const std::uint64_t* in = cells.row(y, z);
        std::uint64_t* out = scratch.row(y, z);
        for (std::size_t w = 0; w < width; ++w) {
          const std::uint64_t before = w > 0 ? in[w - 1] >> 63 : 0,
                              after = w + 1 < width ? in[w + 1] << 63 : 0;
          out[w] = in[w] | in[w] << 1 | in[w] >> 1 | before | after;
        }
      }
      const std::uint64_t* in = scratch.row(0, z);  // along y
      std::uint64_t* out = cells.row(0, z);
      for (std::size_t i = 0; i < layer; ++i)
        out[i] = in[i] | (i >= width ? in[i - width] : 0) | (i + width < layer ? in[i + width] : 0);
    }
  });
  for_each_chunk(cells.layers, layers_at_a_time(layer), [&](std::size_t begin, std::size_t end) {
    for (std::size_t z = begin; z < end; ++z) {
      const std::uint64_t *in = cells.row(0, z), *below = cells.row(0, z > 0 ? z - 1 : z),
                          *above = cells.row(0, z + 1 < cells.layers ? z + 1 : z);
      std::uint64_t* out = scratch.row(0, z);
      for (std::size_t i = 0; i < layer; ++i) out[i] = in[i] | below[i] | above[i];
    }
  });
  std::swap(cells.words, scratch.words);
}

// How often each cell has been counted, up to 15 times: a set for each bit of the number.
struct Counts {
  std::array<Cells, 4> bits;

  // Counts the cells that a set lacks.
  void add_others(const Cells& cells) {
    const std::size_t layer = cells.row_words * cells.rows;
    for_each_chunk(cells.layers, layers_at_a_time(layer), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin * layer; i < end * layer; ++i) {
        std::uint64_t carry = ~cells.words[i];
        for (Cells& bit : bits) carry &= std::exchange(bit.words[i], bit.words[i] ^ carry);
      }
    });
  }
};

// Eight bits as eight numbers of four bits.
constexpr auto kSpread = [] {
  std::array<std::uint32_t, 256> spread{};
  for (unsigned bits = 0; bits < 256; ++bits)
    for (unsigned i = 0; i < 8; ++i) spread[bits] |= (bits >> i & 1U) << (4 * i);
  return spread;
}();

constexpr int kMaxRadius = 15;                        // cells: as much as 4 bits tell
constexpr std::size_t kReach = (kMaxRadius + 1) / 2;  // bricks

BrickBox grown(BrickBox box, const std::array<std::size_t, 3>& bricks) {
  for (std::size_t a = 0; a < 3; ++a) {
    box.begin[a] -= std::min(box.begin[a], kReach);
    box.end[a] = std::min(box.end[a] + kReach, bricks[a]);
  }
  return box;
}

}  // namespace

void measure_open_radii(const std::uint64_t* words, const std::array<std::size_t, 3>& bricks,
                        const BrickBox& changed, std::span<std::uint32_t> radii) {
  const BrickBox measured = grown(changed, bricks), needed = grown(measured, bricks);
  // Calls `visit(brick, x, y, z)` for runs of bricks along x whose cells share the words of their rows.
  constexpr std::size_t kRun = 32;
  const auto for_each_run = [&](const BrickBox& box, const auto& visit) {
    const std::size_t layer = (box.end[0] - box.begin[0]) * (box.end[1] - box.begin[1]);
    const std::size_t layers = layers_at_a_time(layer);
    for_each_chunk(box.end[2] - box.begin[2], layers, [&](std::size_t begin, std::size_t end) {
      for (std::size_t z = box.begin[2] + begin; z < box.begin[2] + end; ++z)
        for (std::size_t y = box.begin[1]; y < box.end[1]; ++y)
          for (std::size_t x = box.begin[0], next = x; x < box.end[0]; x = next) {
            next = std::min(x + kRun - (x - needed.begin[0]) % kRun, box.end[0]);
            visit(x, next, y, z);
          }
    });
  };
  const std::array<std::size_t, 3>& low = needed.begin;
  Cells closed(2 * (needed.end[0] - low[0]), 2 * (needed.end[1] - low[1]), 2 * (needed.end[2] - low[2]));
  Counts radius{{closed, closed, closed, closed}};
  Cells scratch = closed;
  // The words of four rows that hold the cells of a run; those of brick x are the two bits from `shift` on.
  const auto words_of = [&](Cells& cells, std::size_t x, std::size_t y, std::size_t z) {
    std::array<std::uint64_t*, 4> rows;
    for (std::size_t i = 0; i < 4; ++i)
      rows[i] = cells.row(2 * (y - low[1]) + i % 2, 2 * (z - low[2]) + i / 2) + (x - low[0]) / kRun;
    return rows;
  };
  const auto shift = [&](std::size_t x) { return 2 * ((x - low[0]) % kRun); };
  const auto is_within = [](std::size_t at, const BrickBox& box, std::size_t axis) {
    return at >= box.begin[axis] && at < box.end[axis];
  };
  for_each_run(needed, [&](std::size_t begin, std::size_t end, std::size_t y, std::size_t z) {
    const bool may_have_changed = is_within(y, changed, 1) && is_within(z, changed, 2);
    std::array<std::uint64_t, 4> rows{};
    for (std::size_t x = begin; x < end; ++x) {
      const std::size_t brick = (z * bricks[1] + y) * bricks[0] + x;
      const std::uint64_t cells = may_have_changed && is_within(x, changed, 0)
                                      ? closed_cells(words + 8 * brick)
                                      : closed_cells(radii[brick]);
      for (std::size_t i = 0; i < 4; ++i) rows[i] |= (cells >> (8 * i) & 3U) << shift(x);
    }
    const auto out = words_of(closed, begin, y, z);
    for (std::size_t i = 0; i < 4; ++i) *out[i] = rows[i];
  });
  for (int grows = 0; grows < kMaxRadius; ++grows) {
    if (grows > 0) grow(closed, scratch);
    radius.add_others(closed);
  }
  for_each_run(measured, [&](std::size_t begin, std::size_t end, std::size_t y, std::size_t z) {
    std::array<std::array<std::uint64_t, 4>, 4> rows;
    for (std::size_t bit = 0; bit < 4; ++bit) {
      const auto in = words_of(radius.bits[bit], begin, y, z);
      for (std::size_t i = 0; i < 4; ++i) rows[bit][i] = *in[i];
    }
    for (std::size_t x = begin; x < end; ++x) {
      std::uint32_t all = 0;
      for (std::size_t bit = 0; bit < 4; ++bit) {
        std::uint64_t cells = 0;
        for (std::size_t i = 0; i < 4; ++i) cells |= (rows[bit][i] >> shift(x) & 3U) << (2 * i);
        all |= kSpread[cells] << bit;
      }
      radii[(z * bricks[1] + y) * bricks[0] + x] = all;
    }
  });
}

}  // namespace frontlux::detail
