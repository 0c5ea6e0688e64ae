// Lanes by the compiler's vector extensions, for any processor: masks are lanes of all ones. The namespace
// defines kVectorBytes.

struct Lanes {
  static constexpr int kWidth = kVectorBytes / 4;
  using V [[gnu::vector_size(kVectorBytes)]] = std::int32_t;
  using I [[gnu::vector_size(kVectorBytes)]] = std::uint32_t;
  using F [[gnu::vector_size(kVectorBytes)]] = float;
  using M = I;

  static V time(std::int32_t t) { return V{} + t; }
  static V as_time(I a) { return std::bit_cast<V>(a); }
  // Times may wrap around, which numbers with a sign must not.
  static V add(V a, V b) { return as_time(as_whole(a) + as_whole(b)); }
  static V add_if(V a, M m, V b) { return as_time(as_whole(a) + (as_whole(b) & m)); }
  static V add_unless(V a, M m, V b) { return add_if(a, ~m, b); }
  static V subtract(V a, V b) { return as_time(as_whole(a) - as_whole(b)); }
  static V multiply(V a, V b) { return as_time(as_whole(a) * as_whole(b)); }
  // Cut off to a whole number; 0 if that is too large.
  static V product(V a, F b) {
    const F value = __builtin_convertvector(a, F) * b;
    return __builtin_convertvector(std::bit_cast<F>(std::bit_cast<I>(value) & (value * value < 0x1p62F)), V);
  }
  static V min(V a, V b) { return a < b ? a : b; }
  static V max(V a, V b) { return a < b ? b : a; }
  static V min_unsigned(V a, V b) { return as_time(as_whole(a) < as_whole(b) ? as_whole(a) : as_whole(b)); }
  static V choose(M m, V yes, V no) { return as_time(select(m, as_whole(yes), as_whole(no))); }
  static M less(V a, V b) { return std::bit_cast<M>(a < b); }

  static I whole(std::uint32_t i) { return I{} + i; }
  static I as_whole(V a) { return std::bit_cast<I>(a); }
  static I increment(I a) { return a + 1; }
  static I either(I a, I b) { return a | b; }
  static I exclusive(I a, I b) { return a ^ b; }
  static I merge(I where, I a, I b) { return select(where, a, b); }
  static I sum(I a, I b) { return a + b; }
  static I left(I a, std::uint32_t by) { return a << by; }
  static I right(I a, std::uint32_t by) { return a >> by; }
  static I right(I a, I by) { return a >> by; }
  static I select(M m, I yes, I no) { return (yes & m) | (no & ~m); }
  // Of the lanes of `where`; anything elsewhere.
  static I gather(const void* words, I at, M where) {
    const auto* bytes = static_cast<const char*>(words);
    const I safe = at & where;
    I values{};
    for (int lane = 0; lane < kWidth; ++lane) {
      std::uint32_t word = 0;
      std::memcpy(&word, bytes + sizeof word * safe[lane], sizeof word);
      values[lane] = word;
    }
    return values;
  }
  static M closed(const void* words, I at, M where) {
    return (gather(words, at >> 5U, where) >> (at & 31U) & 1U) - 1U;
  }

  static M mask(unsigned bits) {
    M m{};
    for (int lane = 0; lane < kWidth; ++lane) m[lane] = 0U - (bits >> lane & 1U);
    return m;
  }
  static M none() { return M{}; }
  static M both(M a, M b) { return a & b; }
  static M any(M a, M b) { return a | b; }
  static M but_not(M a, M b) { return a & ~b; }
  static unsigned bits(M m) {
    unsigned all = 0;
    for (int lane = 0; lane < kWidth; ++lane) all |= (m[lane] & 1U) << lane;
    return all;
  }

  template <class Vector, class From>
  static void expand(Vector& v, unsigned fill, const From* from) {
    for (int lane = 0; lane < kWidth; ++lane)
      if ((fill >> lane & 1U) != 0) v[lane] = *from++;
  }
  // Writes the lanes of `keep` next to each other.
  static void compress(std::uint32_t* to, unsigned keep, I v) {
    for (int lane = 0; lane < kWidth; ++lane)
      if ((keep >> lane & 1U) != 0) *to++ = v[lane];
  }
  static void store(std::uint32_t* to, I v) {
    for (int lane = 0; lane < kWidth; ++lane) to[lane] = v[lane];
  }
};
