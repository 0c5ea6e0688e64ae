// The walk itself. Included by trie_walk.cpp once for each instruction set, inside a namespace that defines
// `Part`, a vector of the processor's, `HalfPart`, one of at most half a tile, and `any_of` both.

// What the bits of whole tiles are walked by, and those of halves.
struct Whole {
  using Vector = Part;
};
struct Half {
  using Vector = HalfPart;
};

template <class Vector>
[[gnu::always_inline]] inline Vector load(const void* from) {
  Vector vector;
  std::memcpy(&vector, from, sizeof(vector));
  return vector;
}
template <class Vector>
[[gnu::always_inline]] inline void store(void* to, const Vector& vector) {
  std::memcpy(to, &vector, sizeof(vector));
}

// Adds bits to numbers in planes, sixteen at a time, so that carries go beyond the lowest planes seldom.
template <class Size, class Bits>
class Adder {
 public:
  static constexpr std::size_t kSize = 16;
  using Waiting = std::array<Bits, kSize>;

  // For so many bytes of the bits. Room beside this object, so that what is in here stays in registers.
  Adder(PlaceCounts<Bits>& counts, std::size_t bytes, Waiting& waiting)
      : counts_(counts), bytes_(bytes), waiting_(waiting) {
    waiting_.fill({});
  }
  ~Adder() {
    clear_next();
    flush(counts_, bytes_, waiting_);
  }
  Adder(const Adder&) = delete;
  Adder& operator=(const Adder&) = delete;

  // Room for the bits to add next. What is not written there is zero, or what has been written before if
  // that was not added; `clear_next` makes that zero, too.
  [[nodiscard]] [[gnu::always_inline]] std::byte* next() {
    return reinterpret_cast<std::byte*>(&waiting_[size_]);
  }
  void clear_next() { *reinterpret_cast<Bits*>(next()) = {}; }
  // Adds what is there. Without a branch on whether there is something to add.
  [[gnu::always_inline]] void add(bool something) {
    std::size_t one = something ? 1 : 0;
    __asm__("" : "+r"(one));  // else the compiler makes a branch of it, which is hard to predict
    size_ += one;
    if (size_ == kSize) [[unlikely]] {
      flush(counts_, bytes_, waiting_);
      size_ = 0;
    }
  }

 private:
  using Vector = typename Size::Vector;
  static constexpr std::size_t kLowPlanes = 4;

  static std::byte* at(Bits& bits, std::size_t byte) { return reinterpret_cast<std::byte*>(&bits) + byte; }

  [[gnu::noinline]] static void flush(PlaceCounts<Bits>& counts, std::size_t bytes, Waiting& waiting) {
    counts.used = std::max(counts.used, kLowPlanes);
    for (std::size_t byte = 0; byte < bytes; byte += sizeof(Vector)) {
      Vector carries[kSize];
      for (std::size_t i = 0; i < kSize; ++i) {
        carries[i] = load<Vector>(at(waiting[i], byte));
        store(at(waiting[i], byte), Vector{});
      }
      std::size_t count = kSize;
      for (std::size_t plane = 0; plane < kLowPlanes; ++plane) {
        Vector sum = load<Vector>(at(counts.planes[plane], byte));
        count /= 2;
        for (std::size_t i = 0; i < count; ++i)
          carries[i] = add_three(sum, carries[2 * i], carries[2 * i + 1]);
        store(at(counts.planes[plane], byte), sum);
      }
      Vector carry = carries[0];
      for (std::size_t plane = kLowPlanes; any_of(carry); ++plane) {
        const Vector before = load<Vector>(at(counts.planes[plane], byte));
        store<Vector>(at(counts.planes[plane], byte), before ^ carry);
        carry &= before;
        counts.used = std::max(counts.used, plane + 1);
      }
    }
  }

  // `sum` becomes the lower bit of the three; returns the upper.
  [[gnu::always_inline]] static Vector add_three(Vector& sum, const Vector& a, const Vector& b) {
    const Vector differ = sum ^ a;
    const Vector carry = (sum & a) | (differ & b);
    sum = differ ^ b;
    return carry;
  }

  PlaceCounts<Bits>& counts_;
  std::size_t bytes_;
  std::size_t size_ = 0;
  Waiting& waiting_;
};

void add_up(const std::byte* table, std::span<const std::int32_t> places, const TileBits& viewpoints,
            TileCounts& counts) {
  const auto* const here = reinterpret_cast<const std::byte*>(&viewpoints);
  typename Adder<Whole, TileBits>::Waiting waiting;
  Adder<Whole, TileBits> adder(counts, sizeof(TileBits), waiting);
  for (const std::int32_t place : places) {
    std::byte* const there = adder.next();
    Part any{};
    for (std::size_t byte = 0; byte < sizeof(TileBits); byte += sizeof(Part)) {
      const Part bits = load<Part>(here + byte) & load<Part>(table + place + byte);
      store(there + byte, bits);
      any |= bits;
    }
    adder.add(any_of(any));
  }
}

// Some of the vectors of parts: where they begin in windows, and among the parts' bits.
template <class Size>
struct Vectors {
  static constexpr std::size_t kStep = sizeof(typename Size::Vector);
  std::size_t size = 0;
  std::array<std::size_t, TileParts::kBytes / kStep> begins, bytes;

  [[nodiscard]] static Vectors of(const TileParts& parts) {
    Vectors all;
    for (std::size_t p = 0; p < parts.size; ++p)
      for (std::size_t byte = 0; byte < parts.part_bytes(); byte += kStep, ++all.size) {
        all.begins[all.size] = parts.begins[p] + byte;
        all.bytes[all.size] = all.size * kStep;
      }
    return all;
  }
};

template <class Size>
bool find_groups_by(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* targets,
                    const TileParts& parts, const PartBits& viewpoints, std::span<PartBits> groups) {
  using Vector = typename Size::Vector;
  const auto vectors = Vectors<Size>::of(parts);
  const auto* const here = reinterpret_cast<const std::byte*>(&viewpoints);
  const std::int32_t* const places = trie.targets().data();
  Vector all{};
  for (std::uint32_t g = sector.groups_begin; g < sector.groups_end; ++g) {
    const RayTrie::Group group = trie.groups()[g];
    auto* const out = reinterpret_cast<std::byte*>(&groups[g - sector.groups_begin]);
    for (std::size_t v = 0; v < vectors.size; ++v) {
      const std::byte* const there = targets + vectors.begins[v];
      Vector found{};
      for (std::uint32_t t = group.begin; t < group.end; ++t) found |= load<Vector>(there + places[t]);
      found &= load<Vector>(here + v * sizeof(Vector));
      store(out + v * sizeof(Vector), found);
      all |= found;
    }
  }
  return any_of(all);
}

bool find_groups(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* targets,
                 const TileParts& parts, const PartBits& viewpoints, std::span<PartBits> groups) {
  return parts.half ? find_groups_by<Half>(trie, sector, targets, parts, viewpoints, groups)
                    : find_groups_by<Whole>(trie, sector, targets, parts, viewpoints, groups);
}

// Counts by visits to nodes.
template <class Size>
class Counter {
 public:
  using Vector = typename Size::Vector;
  static constexpr std::size_t kStep = sizeof(Vector);

  Counter(const RayTrie& trie, const std::byte* free, const std::byte* targets, std::span<PartBits> reached,
          std::span<const PartBits> groups, Adder<Size, PartBits>& adder)
      : nodes_(trie.nodes().data()),
        free_(free),
        targets_(targets),
        reached_by_all_(reinterpret_cast<std::byte*>(reached.data())),
        reached_by_some_(reinterpret_cast<std::byte*>(reached.data() + reached.size() / 2)),
        groups_(groups),
        adder_(adder) {}

  void walk(const RayTrie::Sector& sector, const Vectors<Size>& all) {
    visit<true>(sector.nodes_begin, sector.nodes_end, all, reached_by_all_);
  }

 private:
  // @param reached  by depth, of the vectors, one after the other
  template <bool kFindGroups>
  void visit(std::uint32_t begin, std::uint32_t end, const Vectors<Size>& vectors, std::byte* reached) {
    for (std::uint32_t n = begin; n < end;) {
      const RayTrie::Node& node = nodes_[n];
      const std::uint32_t behind = node.end;
      if constexpr (kFindGroups)
        if (node.group != 0) {
          visit_group(n, vectors);
          n = behind;
          continue;
        }
      const bool is_fork = node.is_fork != 0;
      std::byte* const near = reached + node.depth * sizeof(PartBits);
      // Most nodes have no target: that is well worth a branch.
      const bool any =
          node.is_target != 0 ? step<true>(node, vectors, near) : step<false>(node, vectors, near);
      n = (is_fork & !any) ? behind : n + 1;
    }
  }

  // The nodes of a group, for those vectors only that have a target there.
  [[gnu::noinline]] void visit_group(std::uint32_t first, const Vectors<Size>& all) {
    const RayTrie::Node& node = nodes_[first];
    const auto* const group = reinterpret_cast<const std::byte*>(&groups_[node.group - 1]);
    const std::byte* const near = reached_by_all_ + node.depth * sizeof(PartBits);
    std::byte* const out = reached_by_some_ + node.depth * sizeof(PartBits);
    Vectors<Size> some;
    for (std::size_t v = 0; v < all.size; ++v) {
      const Vector bits = load<Vector>(near + v * kStep) & load<Vector>(group + v * kStep);
      store(out + some.size * kStep, bits);
      some.begins[some.size] = all.begins[v];
      some.bytes[some.size] = all.bytes[v];
      some.size += any_of(bits) ? 1 : 0;
    }
    if (some.size == 0) return;
    adder_.clear_next();
    visit<false>(first, node.end, some, reached_by_some_);
  }

  // Goes on to the end of a node. False if none does.
  template <bool kTarget>
  [[gnu::always_inline]] bool step(const RayTrie::Node& node, const Vectors<Size>& vectors, std::byte* near) {
    const std::byte *const step0 = free_ + node.steps[0], *const step1 = free_ + node.steps[1];
    const std::byte *const step2 = free_ + node.steps[2], *const step3 = free_ + node.steps[3];
    const std::byte* const target = targets_ + node.target;
    std::byte* const out = adder_.next();
    const std::size_t size = vectors.size;
    Vector any_far{}, any_seen{};
    for (std::size_t v = 0; v < size; ++v) {
      const std::size_t at = vectors.begins[v];
      const Vector first_steps = load<Vector>(step0 + at) & load<Vector>(step1 + at);
      const Vector steps = first_steps & load<Vector>(step2 + at) & load<Vector>(step3 + at);
      const Vector far = load<Vector>(near + v * kStep) & steps;
      store(near + sizeof(PartBits) + v * kStep, far);
      any_far |= far;
      if constexpr (kTarget) {
        const Vector seen = far & load<Vector>(target + at);
        store(out + vectors.bytes[v], seen);
        any_seen |= seen;
      }
    }
    if constexpr (kTarget) adder_.add(any_of(any_seen));
    return any_of(any_far);
  }

  const RayTrie::Node* nodes_;
  const std::byte *free_, *targets_;
  std::byte *reached_by_all_, *reached_by_some_;
  std::span<const PartBits> groups_;
  Adder<Size, PartBits>& adder_;
};

template <class Size>
void count_by(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* free,
              const std::byte* targets, const TileParts& parts, std::span<const PartBits> groups,
              const PartBits& viewpoints, std::span<PartBits> reached, PartCounts& counts) {
  using Vector = typename Size::Vector;
  const auto vectors = Vectors<Size>::of(parts);
  typename Adder<Size, PartBits>::Waiting waiting;
  Adder<Size, PartBits> adder(counts, parts.bytes(), waiting);
  const auto* const here = reinterpret_cast<const std::byte*>(&viewpoints);
  const auto first = trie.groups()[sector.groups_begin].begin;
  for (const std::int32_t place : trie.targets().subspan(first, sector.adjacent)) {
    std::byte* const out = adder.next();
    Vector any{};
    for (std::size_t v = 0; v < vectors.size; ++v) {
      const std::size_t byte = vectors.bytes[v];
      const Vector seen = load<Vector>(here + byte) & load<Vector>(targets + place + vectors.begins[v]);
      store(out + byte, seen);
      any |= seen;
    }
    adder.add(any_of(any));
  }
  reached.front() = viewpoints;
  Counter<Size>(trie, free, targets, reached, groups, adder).walk(sector, vectors);
}

void count(const RayTrie& trie, const RayTrie::Sector& sector, const std::byte* free,
           const std::byte* targets, const TileParts& parts, std::span<const PartBits> groups,
           const PartBits& viewpoints, std::span<PartBits> reached, PartCounts& counts) {
  if (parts.half)
    count_by<Half>(trie, sector, free, targets, parts, groups, viewpoints, reached, counts);
  else
    count_by<Whole>(trie, sector, free, targets, parts, groups, viewpoints, reached, counts);
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
