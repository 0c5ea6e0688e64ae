// The walk itself. Included by tree_walk.cpp once for each instruction set, inside a namespace that defines
// `any_of(const Bits&)`. Bits are 64 bytes everywhere: the compiler makes of them what the processor has.

[[gnu::always_inline]] inline Bits load(const void* from) {
  Bits bits;
  std::memcpy(&bits, from, sizeof(bits));
  return bits;
}
[[gnu::always_inline]] inline void store(void* to, const Bits& bits) { std::memcpy(to, &bits, sizeof(bits)); }

// Adds bits to numbers in planes, fifteen at a time, so that most carries stay in registers.
class Adder {
 public:
  explicit Adder(TileCounts& counts) : counts_(counts) {}

  // Takes no branch on whether there is something to add.
  [[gnu::always_inline]] void add(const Bits& bits, bool worth) {
    store(&waiting_[size_], bits);
    size_ += worth ? 1 : 0;
    if (size_ == kSize) [[unlikely]]
      flush();
  }
  [[gnu::noinline]] void flush() {
    for (std::size_t i = size_; i < kSize; ++i) waiting_[i] = TileBits{};
    Bits four[5], two[2];
    std::size_t i = 0;
    Bits one = load(&waiting_[i++]);
    // 15 ones become 1 + 2 + 4 + 8, by adders of three bits.
    Bits twos[7];
    for (Bits& carry : twos) {
      carry = add_three(one, load(&waiting_[i]), load(&waiting_[i + 1]));
      i += 2;
    }
    Bits sum_two = twos[0];
    for (std::size_t k = 0; k < 3; ++k) four[k] = add_three(sum_two, twos[2 * k + 1], twos[2 * k + 2]);
    Bits sum_four = four[0];
    two[0] = add_three(sum_four, four[1], four[2]);
    ripple(0, one);
    ripple(1, sum_two);
    ripple(2, sum_four);
    ripple(3, two[0]);
    size_ = 0;
  }

 private:
  static constexpr std::size_t kSize = 15;

  // `sum` becomes the lower bit of the three; returns the upper.
  [[gnu::always_inline]] static Bits add_three(Bits& sum, const Bits& a, const Bits& b) {
    const Bits differ = sum ^ a;
    const Bits carry = (sum & a) | (differ & b);
    sum = differ ^ b;
    return carry;
  }
  [[gnu::always_inline]] void ripple(std::size_t plane, const Bits& added) {
    Bits carry = added;
    for (; any_of(carry); ++plane) {
      const Bits before = load(&counts_.planes[plane]);
      store(&counts_.planes[plane], before ^ carry);
      carry &= before;
      counts_.used = std::max(counts_.used, plane + 1);
    }
  }

  TileCounts& counts_;
  std::size_t size_ = 0;
  std::array<TileBits, kSize> waiting_;
};

void gather(std::span<const std::int32_t> places, const std::byte* targets, const TileBits& viewpoints,
            TileCounts& counts, TileBits& any) {
  const Bits here = load(&viewpoints);
  Bits found = here ^ here;
  Adder adder(counts);
  for (const std::int32_t place : places) {
    const Bits there = here & load(targets + place);
    found |= there;
    adder.add(there, any_of(there));
  }
  adder.flush();
  store(&any, found);
}

void count(const PathTree& tree, const PathTree::Sector& sector, const std::byte* free,
           const std::byte* targets, std::span<const TileBits> groups, const TileBits& viewpoints,
           std::span<TileBits> reached, TileCounts& counts) {
  Adder adder(counts);
  const Bits here = load(&viewpoints);
  const auto first = tree.groups()[sector.groups_begin].begin;
  for (const std::int32_t place : tree.targets().subspan(first, sector.adjacent)) {
    const Bits seen = here & load(targets + place);
    adder.add(seen, any_of(seen));
  }
  store(&reached[0], here);
  const PathTree::Node* const nodes = tree.nodes().data();
  TileBits* const at_depth = reached.data();
  for (std::uint32_t n = sector.nodes_begin; n < sector.nodes_end;) {
    const PathTree::Node& node = nodes[n];
    const Bits near = load(&at_depth[node.depth]) & load(&groups[node.group]);
    const Bits first_steps = load(free + node.steps[0]) & load(free + node.steps[1]);
    const Bits steps = first_steps & load(free + node.steps[2]) & load(free + node.steps[3]);
    const Bits far = near & steps;
    store(&at_depth[node.depth + 1], far);
    const Bits seen = far & load(targets + node.target);
    adder.add(seen, static_cast<bool>(node.is_target & static_cast<unsigned>(any_of(seen))));
    const bool leave = static_cast<bool>(node.is_fork & static_cast<unsigned>(!any_of(far)));
    n = leave ? node.end : n + 1;
  }
  adder.flush();
}

void spread(const SpreadFrom& from, std::size_t rows, std::size_t columns, std::size_t column_stride,
            std::uint16_t* out) {
  for (std::size_t column = 0; column < columns; ++column, out += column_stride) {
    const std::size_t bit = from.first_bit + column;
    const std::uint8_t* const low = from.bytes + bit / 8 * from.pitch;
    const std::uint8_t* const middle = low + from.pitch;
    const std::uint8_t* const high = middle + from.pitch;
    const unsigned shift = bit % 8;
#pragma GCC ivdep
    for (std::size_t row = 0; row < rows; ++row) {
      const auto two = static_cast<std::uint16_t>(low[row] | middle[row] << 8U);
      const auto third = static_cast<std::uint16_t>(high[row] << 8U);
      out[row] = static_cast<std::uint16_t>(two >> shift | third << (8 - shift));
    }
  }
}
