// Lanes of AVX-512: masks are bits.

struct Lanes {
  static constexpr int kWidth = 16;
  using V = __m512i;
  using I = __m512i;
  using F = __m512;
  using M = __mmask16;

  static V time(std::int32_t t) { return _mm512_set1_epi32(t); }
  static V as_time(I a) { return a; }
  static V add(V a, V b) { return _mm512_add_epi32(a, b); }
  static V add_if(V a, M m, V b) { return _mm512_mask_add_epi32(a, m, a, b); }
  static V add_unless(V a, M m, V b) { return add_if(a, static_cast<M>(~m), b); }
  static V subtract(V a, V b) { return _mm512_sub_epi32(a, b); }
  static V multiply(V a, V b) { return _mm512_mullo_epi32(a, b); }
  // Cut off to a whole number.
  static V product(V a, F b) { return _mm512_cvttps_epi32(_mm512_mul_ps(_mm512_cvtepi32_ps(a), b)); }
  static V min(V a, V b) { return _mm512_min_epi32(a, b); }
  static V max(V a, V b) { return _mm512_max_epi32(a, b); }
  static V min_unsigned(V a, V b) { return _mm512_min_epu32(a, b); }
  static V choose(M m, V yes, V no) { return _mm512_mask_mov_epi32(no, m, yes); }
  static M less(V a, V b) { return _mm512_cmplt_epi32_mask(a, b); }

  static I whole(std::uint32_t i) { return _mm512_set1_epi32(static_cast<int>(i)); }
  static I as_whole(V a) { return a; }
  static I increment(I a) { return _mm512_sub_epi32(a, _mm512_set1_epi32(-1)); }
  static I both(I a, I b) { return _mm512_and_si512(a, b); }
  static I either(I a, I b) { return _mm512_or_si512(a, b); }
  static I exclusive(I a, I b) { return _mm512_xor_si512(a, b); }
  static I merge(I where, I a, I b) { return _mm512_ternarylogic_epi32(where, a, b, 0xCA); }
  static I sum(I a, I b) { return _mm512_add_epi32(a, b); }
  static I left(I a, std::uint32_t by) {
    return _mm512_sll_epi32(a, _mm_cvtsi32_si128(static_cast<int>(by)));
  }
  static I right(I a, std::uint32_t by) {
    return _mm512_srl_epi32(a, _mm_cvtsi32_si128(static_cast<int>(by)));
  }
  static I right(I a, I by) { return _mm512_srlv_epi32(a, by); }
  static I select(M m, I yes, I no) { return _mm512_mask_mov_epi32(no, m, yes); }
  // Of the lanes of `where`; 0 elsewhere.
  static I gather(const void* words, I at, M where) {
    return _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), where, at, words, 4);
  }
  static M closed(const void* words, I at, M where) {
    const I word = gather(words, _mm512_srli_epi32(at, 5), where);
    return _mm512_testn_epi32_mask(_mm512_rorv_epi32(word, at), _mm512_set1_epi32(1));
  }

  static M mask(unsigned bits) { return static_cast<M>(bits); }
  static M none() { return 0; }
  static M both(M a, M b) { return static_cast<M>(a & b); }
  static M any(M a, M b) { return static_cast<M>(a | b); }
  static M but_not(M a, M b) { return static_cast<M>(a & ~b); }
  static unsigned bits(M m) { return m; }

  static void expand(V& v, unsigned fill, const void* from) {
    v = _mm512_mask_expandloadu_epi32(v, static_cast<M>(fill), from);
  }
  static void expand(F& v, unsigned fill, const void* from) {
    v = _mm512_mask_expandloadu_ps(v, static_cast<M>(fill), from);
  }
  // Writes the lanes of `keep` next to each other, and anything behind them, a register in all.
  static void compress(std::uint32_t* to, unsigned keep, I v) {
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<M>(keep), v));
  }
  static void store(std::uint32_t* to, I v) { _mm512_store_si512(to, v); }
};
