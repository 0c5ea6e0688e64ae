// Lanes by the compiler's vector extensions, for any processor: masks are lanes of all ones. The namespace
// defines kVectorBytes.

struct Lanes {
  static constexpr int kWidth = kVectorBytes / 4;
  using V [[gnu::vector_size(kVectorBytes)]] = std::int32_t;
  using I [[gnu::vector_size(kVectorBytes)]] = std::uint32_t;
  using M = I;

  static V time(std::int32_t t) { return V{} + t; }
  static I whole(std::uint32_t i) { return I{} + i; }
  static M mask(unsigned bits) {
    M m{};
    for (int lane = 0; lane < kWidth; ++lane) m[lane] = 0U - (bits >> lane & 1U);
    return m;
  }
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
  static void store(std::uint32_t* to, I v) {
    for (int lane = 0; lane < kWidth; ++lane) to[lane] = v[lane];
  }
  static M less(V a, V b) { return std::bit_cast<M>(a < b); }
  static V min(V a, V b) { return a < b ? a : b; }
  static V max(V a, V b) { return a < b ? b : a; }
  static V subtract(V a, V b) { return std::bit_cast<V>(std::bit_cast<I>(a) - std::bit_cast<I>(b)); }
  static M is_zero(V a) { return std::bit_cast<M>(a == 0); }
  static V add_if(V a, M m, V b) {
    return std::bit_cast<V>(std::bit_cast<I>(a) + (std::bit_cast<I>(b) & m));
  }
  static V add_unless(V a, M m, V b) { return add_if(a, ~m, b); }
  static I increment(I a) { return a + 1; }
  static M closed(const void* words, I at, M running) {
    const auto* word = static_cast<const std::uint32_t*>(words);
    const I safe = at & running;
    I open{};
    for (int lane = 0; lane < kWidth; ++lane) open[lane] = word[safe[lane] >> 5U] >> (safe[lane] & 31U) & 1U;
    return open - 1;
  }
  static I select(M m, I yes, I no) { return (yes & m) | (no & ~m); }
  static V choose(M m, V yes, V no) {
    return std::bit_cast<V>(select(m, std::bit_cast<I>(yes), std::bit_cast<I>(no)));
  }
  static M none() { return M{}; }
  static M both(M a, M b) { return a & b; }
  static M any(M a, M b) { return a | b; }
  static M but_not(M a, M b) { return a & ~b; }
  static I either(I a, I b) { return a | b; }
  static I exclusive(I a, I b) { return a ^ b; }
  static I merge(I where, I a, I b) { return select(where, a, b); }
};
