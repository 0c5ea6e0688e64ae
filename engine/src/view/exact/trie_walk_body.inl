// The walk itself. Included by trie_walk.cpp once for each instruction set, inside a namespace that defines
// `Part`, a vector of the processor's, `HalfPart`, one of at most half a tile, and `any_of` both.

// The vectors that hold a tile, and half of its rows.
struct Whole {
  using Vector = Part;
  static constexpr std::size_t kParts = ViewTile::kBytes / sizeof(Vector);
};
struct Half {
  using Vector = HalfPart;
  static constexpr std::size_t kParts = ViewTile::kBytes / 2 / sizeof(Vector);
};

// The bits of either.
template <class Size>
struct BitsOf {
  static constexpr std::size_t kParts = Size::kParts;
  typename Size::Vector parts[kParts];

  [[gnu::always_inline]] BitsOf& operator&=(const BitsOf& b) {
    for (std::size_t i = 0; i < kParts; ++i) parts[i] &= b.parts[i];
    return *this;
  }
  [[gnu::always_inline]] BitsOf& operator|=(const BitsOf& b) {
    for (std::size_t i = 0; i < kParts; ++i) parts[i] |= b.parts[i];
    return *this;
  }
  [[gnu::always_inline]] BitsOf& operator^=(const BitsOf& b) {
    for (std::size_t i = 0; i < kParts; ++i) parts[i] ^= b.parts[i];
    return *this;
  }
  [[gnu::always_inline]] friend BitsOf operator&(BitsOf a, const BitsOf& b) { return a &= b; }
  [[gnu::always_inline]] friend BitsOf operator|(BitsOf a, const BitsOf& b) { return a |= b; }
  [[gnu::always_inline]] friend BitsOf operator^(BitsOf a, const BitsOf& b) { return a ^= b; }
};

template <class Size>
[[gnu::always_inline]] inline bool any_of(const BitsOf<Size>& bits) {
  auto all = bits.parts[0];
  for (std::size_t i = 1; i < Size::kParts; ++i) all |= bits.parts[i];
  return any_of(all);
}

template <class Bits>
[[gnu::always_inline]] inline Bits load(const void* from) {
  Bits bits;
  for (std::size_t i = 0; i < Bits::kParts; ++i)
    std::memcpy(&bits.parts[i], static_cast<const std::byte*>(from) + i * sizeof(bits.parts[i]),
                sizeof(bits.parts[i]));
  return bits;
}
template <class Bits>
[[gnu::always_inline]] inline void store(void* to, const Bits& bits) {
  for (std::size_t i = 0; i < Bits::kParts; ++i)
    std::memcpy(static_cast<std::byte*>(to) + i * sizeof(bits.parts[i]), &bits.parts[i],
                sizeof(bits.parts[i]));
}

// The part of a tile that begins with a row.
[[gnu::always_inline]] inline std::byte* from_row(TileBits* bits, std::size_t row) {
  return reinterpret_cast<std::byte*>(bits) + row * ViewTile::kRowBytes;
}
[[gnu::always_inline]] inline const std::byte* from_row(const TileBits* bits, std::size_t row) {
  return reinterpret_cast<const std::byte*>(bits) + row * ViewTile::kRowBytes;
}

// Adds bits to numbers in planes, sixteen at a time, so that carries go beyond the lowest planes seldom.
template <class Bits>
class Adder {
 public:
  static constexpr std::size_t kSize = 16;
  using Waiting = std::array<TileBits, kSize>;

  // For the part of a tile that begins with a row. Room beside this object, so that what is in here stays in
  // registers.
  Adder(TileCounts& counts, std::size_t row, Waiting& waiting)
      : counts_(counts), row_(row), waiting_(waiting) {}
  ~Adder() { flush(counts_, row_, waiting_, size_); }
  Adder(const Adder&) = delete;
  Adder& operator=(const Adder&) = delete;

  // Without a branch on whether there is something to add.
  [[gnu::always_inline]] void add(const Bits& bits, bool something) {
    store(&waiting_[size_], bits);
    std::size_t one = something ? 1 : 0;
    __asm__("" : "+r"(one));  // else the compiler makes a branch of it, which is hard to predict
    size_ += one;
    if (size_ == kSize) [[unlikely]] {
      flush(counts_, row_, waiting_, size_);
      size_ = 0;
    }
  }

 private:
  static constexpr std::size_t kLowPlanes = 4;

  [[gnu::noinline]] static void flush(TileCounts& counts, std::size_t row, Waiting& waiting,
                                      std::size_t size) {
    std::fill(waiting.begin() + static_cast<std::ptrdiff_t>(size), waiting.end(), TileBits{});
    std::array<Bits, kSize> carries;
    for (std::size_t i = 0; i < kSize; ++i) carries[i] = load<Bits>(&waiting[i]);
    std::size_t count = kSize;
    for (std::size_t plane = 0; plane < kLowPlanes; ++plane) {
      Bits sum = load<Bits>(from_row(&counts.planes[plane], row));
      count /= 2;
      for (std::size_t i = 0; i < count; ++i) carries[i] = add_three(sum, carries[2 * i], carries[2 * i + 1]);
      store(from_row(&counts.planes[plane], row), sum);
    }
    counts.used = std::max(counts.used, kLowPlanes);
    Bits carry = carries[0];
    for (std::size_t plane = kLowPlanes; any_of(carry); ++plane) {
      const Bits before = load<Bits>(from_row(&counts.planes[plane], row));
      store(from_row(&counts.planes[plane], row), before ^ carry);
      carry &= before;
      counts.used = std::max(counts.used, plane + 1);
    }
  }

  // `sum` becomes the lower bit of the three; returns the upper.
  [[gnu::always_inline]] static Bits add_three(Bits& sum, const Bits& a, const Bits& b) {
    const Bits differ = sum ^ a;
    const Bits carry = (sum & a) | (differ & b);
    sum = differ ^ b;
    return carry;
  }

  TileCounts& counts_;
  std::size_t row_;
  std::size_t size_ = 0;
  Waiting& waiting_;
};

using WholeBits = BitsOf<Whole>;
using HalfBits = BitsOf<Half>;

void add_up(const std::byte* table, std::span<const std::int32_t> places, const TileBits& viewpoints,
            TileCounts& counts) {
  const WholeBits here = load<WholeBits>(&viewpoints);
  typename Adder<WholeBits>::Waiting waiting;
  Adder<WholeBits> adder(counts, 0, waiting);
  for (const std::int32_t place : places) {
    const WholeBits there = here & load<WholeBits>(table + place);
    adder.add(there, any_of(there));
  }
}

template <class Bits>
bool find_groups_from(std::size_t row, const RayTrie& trie, const RayTrie::Sector& sector,
                      const std::byte* targets, const TileBits& viewpoints, std::span<TileBits> groups) {
  const Bits here = load<Bits>(from_row(&viewpoints, row));
  const std::byte* const windows = targets + row * ViewTile::kRowBytes;
  Bits all = here ^ here;
  for (std::uint32_t g = sector.groups_begin; g < sector.groups_end; ++g) {
    const RayTrie::Group& group = trie.groups()[g];
    Bits found = here ^ here;
    for (std::uint32_t t = group.begin; t < group.end; ++t) found |= load<Bits>(windows + trie.targets()[t]);
    found &= here;
    store(from_row(&groups[g], row), found);
    all |= found;
  }
  return any_of(all);
}

bool find_groups(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* targets,
                 const TileBits& viewpoints, const TileRows& rows, std::span<TileBits> groups) {
  return rows.half ? find_groups_from<HalfBits>(rows.first, trie, sector, targets, viewpoints, groups)
                   : find_groups_from<WholeBits>(0, trie, sector, targets, viewpoints, groups);
}

template <class Bits>
void count_from(std::size_t row, const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* free,
                const std::byte* targets, std::span<const TileBits> groups, const TileBits& viewpoints,
                std::span<TileBits> reached, TileCounts& counts) {
  typename Adder<Bits>::Waiting waiting;
  Adder<Bits> adder(counts, row, waiting);
  const Bits here = load<Bits>(from_row(&viewpoints, row));
  free += row * ViewTile::kRowBytes;
  targets += row * ViewTile::kRowBytes;
  const auto first = trie.groups()[sector.groups_begin].begin;
  for (const std::int32_t place : trie.targets().subspan(first, sector.adjacent)) {
    const Bits seen = here & load<Bits>(targets + place);
    adder.add(seen, any_of(seen));
  }
  store(&reached[0], here);
  const RayTrie::Node* const nodes = trie.nodes().data();
  TileBits* const at_depth = reached.data();
  const TileBits* const in_groups = groups.data();
  for (std::uint32_t n = sector.nodes_begin; n < sector.nodes_end;) {
    const RayTrie::Node& node = nodes[n];
    const Bits near = load<Bits>(&at_depth[node.depth]) & load<Bits>(from_row(&in_groups[node.group], row));
    const Bits first_steps = load<Bits>(free + node.steps[0]) & load<Bits>(free + node.steps[1]);
    const Bits steps = first_steps & load<Bits>(free + node.steps[2]) & load<Bits>(free + node.steps[3]);
    const Bits far = near & steps;
    store(&at_depth[node.depth + 1U], far);
    const Bits seen = far & load<Bits>(targets + node.target);
    adder.add(seen, static_cast<bool>(node.is_target & static_cast<unsigned>(any_of(seen))));
    const bool leave = static_cast<bool>(node.is_fork & static_cast<unsigned>(!any_of(far)));
    n = leave ? node.end : n + 1;
  }
}

void count(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* free,
           const std::byte* targets, std::span<const TileBits> groups, const TileBits& viewpoints,
           const TileRows& rows, std::span<TileBits> reached, TileCounts& counts) {
  if (rows.half)
    count_from<HalfBits>(rows.first, trie, sector, free, targets, groups, viewpoints, reached, counts);
  else
    count_from<WholeBits>(0, trie, sector, free, targets, groups, viewpoints, reached, counts);
}

void spread(const SpreadFrom& from, std::size_t rows, std::size_t columns, std::size_t column_stride,
            std::uint16_t* out) {
  for (std::size_t column = 0; column < columns; ++column, out += column_stride) {
    const std::size_t bit = from.first_bit + column;
    const std::uint8_t* const low = from.bytes + bit / 8 * from.pitch;
    const std::uint8_t* const middle = low + from.pitch;
    const std::uint8_t* const high = middle + from.pitch;
    const unsigned shift = bit % 8;
#ifdef __clang__  // rows do not overlap
#pragma clang loop vectorize(assume_safety)
#else
#pragma GCC ivdep
#endif
    for (std::size_t row = 0; row < rows; ++row) {
      const auto two = static_cast<std::uint16_t>(low[row] | middle[row] << 8U);
      const auto third = static_cast<std::uint16_t>(high[row] << 8U);
      out[row] = static_cast<std::uint16_t>(two >> shift | third << (8 - shift));
    }
  }
}
