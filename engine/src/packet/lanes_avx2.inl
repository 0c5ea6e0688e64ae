// Lanes of AVX2: masks are lanes of all ones.

struct Lanes {
  static constexpr int kWidth = 8;
  using V = __m256i;
  using I = __m256i;
  using F = __m256;
  using M = __m256i;

  static V time(std::int32_t t) { return _mm256_set1_epi32(t); }
  static V as_time(I a) { return a; }
  static V add(V a, V b) { return _mm256_add_epi32(a, b); }
  static V add_if(V a, M m, V b) { return _mm256_add_epi32(a, _mm256_and_si256(m, b)); }
  static V add_unless(V a, M m, V b) { return _mm256_add_epi32(a, _mm256_andnot_si256(m, b)); }
  static V subtract(V a, V b) { return _mm256_sub_epi32(a, b); }
  static V multiply(V a, V b) { return _mm256_mullo_epi32(a, b); }
  // Cut off to a whole number.
  static V product(V a, F b) { return _mm256_cvttps_epi32(_mm256_mul_ps(_mm256_cvtepi32_ps(a), b)); }
  static V min(V a, V b) { return _mm256_min_epi32(a, b); }
  static V max(V a, V b) { return _mm256_max_epi32(a, b); }
  static V min_unsigned(V a, V b) { return _mm256_min_epu32(a, b); }
  static V choose(M m, V yes, V no) { return _mm256_blendv_epi8(no, yes, m); }
  static M less(V a, V b) { return _mm256_cmpgt_epi32(b, a); }

  static I whole(std::uint32_t i) { return _mm256_set1_epi32(static_cast<int>(i)); }
  static I as_whole(V a) { return a; }
  static I increment(I a) { return _mm256_sub_epi32(a, _mm256_set1_epi32(-1)); }
  static I either(I a, I b) { return _mm256_or_si256(a, b); }
  static I exclusive(I a, I b) { return _mm256_xor_si256(a, b); }
  static I merge(I where, I a, I b) {
    return _mm256_or_si256(_mm256_and_si256(where, a), _mm256_andnot_si256(where, b));
  }
  static I sum(I a, I b) { return _mm256_add_epi32(a, b); }
  static I left(I a, std::uint32_t by) {
    return _mm256_sll_epi32(a, _mm_cvtsi32_si128(static_cast<int>(by)));
  }
  static I right(I a, std::uint32_t by) {
    return _mm256_srl_epi32(a, _mm_cvtsi32_si128(static_cast<int>(by)));
  }
  static I right(I a, I by) { return _mm256_srlv_epi32(a, by); }
  static I select(M m, I yes, I no) { return _mm256_blendv_epi8(no, yes, m); }
  // Of the lanes of `where`; anything elsewhere. Word by word, which takes two thirds of a gather's time on
  // Zen 3, and where Intel's processors were mended against gather data sampling.
  static I gather(const void* words, I at, M where) {
    const I safe = _mm256_and_si256(at, where);
    const __m128i low = _mm256_castsi256_si128(safe), high = _mm256_extracti128_si256(safe, 1);
    return _mm256_inserti128_si256(
        _mm256_castsi128_si256(four_words(words, _mm_cvtsi128_si64(low), _mm_extract_epi64(low, 1))),
        four_words(words, _mm_cvtsi128_si64(high), _mm_extract_epi64(high, 1)), 1);
  }
  // Two indices in each.
  static __m128i four_words(const void* words, std::int64_t at01, std::int64_t at23) {
    const auto word = [words](std::uint64_t at) {
      int value = 0;
      std::memcpy(&value, static_cast<const char*>(words) + sizeof value * at, sizeof value);
      return value;
    };
    const auto first = static_cast<std::uint64_t>(at01), second = static_cast<std::uint64_t>(at23);
    __m128i four = _mm_cvtsi32_si128(word(first & 0xFFFFFFFFU));
    four = _mm_insert_epi32(four, word(first >> 32U), 1);
    four = _mm_insert_epi32(four, word(second & 0xFFFFFFFFU), 2);
    return _mm_insert_epi32(four, word(second >> 32U), 3);
  }
  static M closed(const void* words, I at, M where) {
    const I word = gather(words, _mm256_srli_epi32(at, 5), where);
    const I bit = _mm256_sllv_epi32(_mm256_set1_epi32(1), _mm256_and_si256(at, _mm256_set1_epi32(31)));
    return _mm256_cmpeq_epi32(_mm256_and_si256(word, bit), _mm256_setzero_si256());
  }

  static M mask(unsigned bits) {
    const I lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return _mm256_cmpeq_epi32(_mm256_and_si256(whole(bits), lane), lane);
  }
  static M none() { return _mm256_setzero_si256(); }
  static M both(M a, M b) { return _mm256_and_si256(a, b); }
  static M any(M a, M b) { return _mm256_or_si256(a, b); }
  static M but_not(M a, M b) { return _mm256_andnot_si256(b, a); }
  static unsigned bits(M m) { return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(m))); }

  static void expand(V& v, unsigned fill, const void* from) {
    const I order = _mm256_load_si256(reinterpret_cast<const __m256i*>(kExpand[fill].data()));
    const I loaded = _mm256_loadu_si256(static_cast<const __m256i*>(from));
    v = _mm256_blendv_epi8(v, _mm256_permutevar8x32_epi32(loaded, order), mask(fill));
  }
  static void expand(F& v, unsigned fill, const void* from) {
    V bits = _mm256_castps_si256(v);
    expand(bits, fill, from);
    v = _mm256_castsi256_ps(bits);
  }
  // Writes the lanes of `keep` next to each other.
  static void compress(std::uint32_t* to, unsigned keep, I v) {
    alignas(32) std::uint32_t all[kWidth];
    store(all, v);
    for (; keep != 0; keep &= keep - 1) *to++ = all[__builtin_ctz(keep)];
  }
  static void store(std::uint32_t* to, I v) { _mm256_store_si256(reinterpret_cast<__m256i*>(to), v); }
};
