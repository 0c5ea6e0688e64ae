// Lanes of AVX-512: masks are bits.

struct Lanes {
  static constexpr int kWidth = 16;
  using V = __m512i;
  using I = __m512i;
  using M = __mmask16;

  static V time(std::int32_t t) { return _mm512_set1_epi32(t); }
  static I whole(std::uint32_t i) { return _mm512_set1_epi32(static_cast<int>(i)); }
  static M mask(unsigned bits) { return static_cast<M>(bits); }
  static unsigned bits(M m) { return m; }
  static void expand(V& v, unsigned fill, const void* from) {
    v = _mm512_mask_expandloadu_epi32(v, static_cast<M>(fill), from);
  }
  static M less(V a, V b) { return _mm512_cmplt_epi32_mask(a, b); }
  static V min(V a, V b) { return _mm512_min_epi32(a, b); }
  static V add_if(V a, M m, V b) { return _mm512_mask_add_epi32(a, m, a, b); }
  static V max(V a, V b) { return _mm512_max_epi32(a, b); }
  static V subtract(V a, V b) { return _mm512_sub_epi32(a, b); }
  static M is_zero(V a) { return _mm512_testn_epi32_mask(a, a); }
  static V add_unless(V a, M m, V b) { return add_if(a, static_cast<M>(~m), b); }
  static I select(M m, I yes, I no) { return _mm512_mask_mov_epi32(no, m, yes); }
  static V choose(M m, V yes, V no) { return select(m, yes, no); }
  static void store(std::uint32_t* to, I v) { _mm512_store_si512(to, v); }
  static M none() { return 0; }
  static M both(M a, M b) { return static_cast<M>(a & b); }
  static M any(M a, M b) { return static_cast<M>(a | b); }
  static M but_not(M a, M b) { return static_cast<M>(a & ~b); }
  static I either(I a, I b) { return _mm512_or_si512(a, b); }
  static I exclusive(I a, I b) { return _mm512_xor_si512(a, b); }
  static I merge(I where, I a, I b) { return _mm512_ternarylogic_epi32(where, a, b, 0xCA); }
  static I increment(I a) { return _mm512_sub_epi32(a, _mm512_set1_epi32(-1)); }
  static M closed(const void* words, I at, M running) {
    const I word =
        _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), running, _mm512_srli_epi32(at, 5), words, 4);
    return _mm512_testn_epi32_mask(_mm512_rorv_epi32(word, at), _mm512_set1_epi32(1));
  }
};
