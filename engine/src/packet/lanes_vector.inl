// Lanes by the compiler's vector extensions, for any processor: masks are lanes of all ones. The namespace
// defines kVectorBytes, or 0 for one lane at a time.

template <class Number, class Word>
struct Vector {
  static constexpr int kBytes = kVectorBytes > 0 ? kVectorBytes : sizeof(Number);
  static constexpr int kWidth = kBytes / sizeof(Number);
  static constexpr Word kBits = 8 * sizeof(Word);
  using V [[gnu::vector_size(kBytes)]] = Number;
  using I [[gnu::vector_size(kBytes)]] = Word;
  using M = I;
  using Time = Number;

  static V time(Time t) { return V{} + t; }
  static I whole(std::uint32_t i) { return I{} + static_cast<Word>(i); }
  static M mask(unsigned bits) {
    M m{};
    for (int lane = 0; lane < kWidth; ++lane) m[lane] = Word{0} - static_cast<Word>(bits >> lane & 1U);
    return m;
  }
  static unsigned bits(M m) {
    unsigned all = 0;
    for (int lane = 0; lane < kWidth; ++lane) all |= static_cast<unsigned>(m[lane] & 1U) << lane;
    return all;
  }
  template <class Lanes, class From>
  static void expand(Lanes& v, unsigned fill, const From* from) {
    for (int lane = 0; lane < kWidth; ++lane)
      if ((fill >> lane & 1U) != 0) v[lane] = *from++;
  }
  static void store(Word* to, I v) {
    for (int lane = 0; lane < kWidth; ++lane) to[lane] = v[lane];
  }
  static M less(V a, V b) { return std::bit_cast<M>(a < b); }
  static V min(V a, V b) { return a < b ? a : b; }
  static V add_if(V a, M m, V b) { return a + std::bit_cast<V>(std::bit_cast<I>(b) & m); }
  static V add_unless(V a, M m, V b) { return a + std::bit_cast<V>(std::bit_cast<I>(b) & ~m); }
  static I increment(I a) { return a + 1; }
  static M closed(const void* words, I at, M running) {
    const auto* word = static_cast<const Word*>(words);
    const I safe = at & running;
    I open{};
    for (int lane = 0; lane < kWidth; ++lane) {
      const Word i = safe[lane];
      open[lane] = word[i / kBits] >> i % kBits & 1U;
    }
    return open - 1;
  }
  static I select(M m, I yes, I no) { return (yes & m) | (no & ~m); }
  static M none() { return M{}; }
  static M both(M a, M b) { return a & b; }
  static M any(M a, M b) { return a | b; }
  static M but_not(M a, M b) { return a & ~b; }
  static I either(I a, I b) { return a | b; }
  static I exclusive(I a, I b) { return a ^ b; }
  static I merge(I where, I a, I b) { return select(where, a, b); }
};

struct Int : Vector<std::int32_t, std::uint32_t> {
  static M is_over(V& left, V, V) {
    left -= 1;
    return std::bit_cast<M>(left == 0);
  }
};

struct Real : Vector<double, std::uint64_t> {
  static M is_over(V& end, V first, V tz) { return std::bit_cast<M>(min(first, tz) > end); }
};
