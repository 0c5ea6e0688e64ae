// Lanes of AVX-512: masks are bits.

struct Int {
  static constexpr int kWidth = 16;
  using V = __m512i;
  using I = __m512i;
  using M = __mmask16;
  using Time = std::int32_t;

  static V time(Time t) { return _mm512_set1_epi32(t); }
  static I whole(std::uint32_t i) { return _mm512_set1_epi32(static_cast<int>(i)); }
  static M mask(unsigned bits) { return static_cast<M>(bits); }
  static unsigned bits(M m) { return m; }
  static void expand(V& v, unsigned fill, const void* from) {
    v = _mm512_mask_expandloadu_epi32(v, static_cast<M>(fill), from);
  }
  static M less(V a, V b) { return _mm512_cmplt_epi32_mask(a, b); }
  static V min(V a, V b) { return _mm512_min_epi32(a, b); }
  static V add_if(V a, M m, V b) { return _mm512_mask_add_epi32(a, m, a, b); }
  static M is_over(V& left, V, V) {
    left = _mm512_sub_epi32(left, _mm512_set1_epi32(1));
    return _mm512_testn_epi32_mask(left, left);
  }
  static I select(M m, I yes, I no) { return _mm512_mask_mov_epi32(no, m, yes); }
  static I increment(I a) { return _mm512_sub_epi32(a, _mm512_set1_epi32(-1)); }
  static M closed(const void* words, I at, M running) {
    const I word =
        _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), running, _mm512_srli_epi32(at, 5), words, 4);
    return _mm512_testn_epi32_mask(_mm512_rorv_epi32(word, at), _mm512_set1_epi32(1));
  }
  FRONTLUX_COMMON_AVX512
};

struct Real {
  static constexpr int kWidth = 8;
  using V = __m512d;
  using I = __m512i;
  using M = __mmask8;
  using Time = double;

  static V time(Time t) { return _mm512_set1_pd(t); }
  static I whole(std::uint32_t i) { return _mm512_set1_epi64(static_cast<long long>(i)); }
  static M mask(unsigned bits) { return static_cast<M>(bits); }
  static unsigned bits(M m) { return m; }
  static void expand(V& v, unsigned fill, const void* from) {
    v = _mm512_mask_expandloadu_pd(v, static_cast<M>(fill), from);
  }
  static void expand(I& v, unsigned fill, const void* from) {
    v = _mm512_mask_expandloadu_epi64(v, static_cast<M>(fill), from);
  }
  static void store(std::uint64_t* to, I v) { _mm512_store_si512(to, v); }
  static M less(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
  static V min(V a, V b) { return _mm512_min_pd(a, b); }
  static V add_if(V a, M m, V b) { return _mm512_mask_add_pd(a, m, a, b); }
  static M is_over(V& end, V first, V tz) {
    return _mm512_cmp_pd_mask(_mm512_min_pd(first, tz), end, _CMP_GT_OQ);
  }
  static I select(M m, I yes, I no) { return _mm512_mask_mov_epi64(no, m, yes); }
  static I increment(I a) { return _mm512_sub_epi64(a, _mm512_set1_epi64(-1)); }
  static M closed(const void* words, I at, M running) {
    const I word =
        _mm512_mask_i64gather_epi64(_mm512_setzero_si512(), running, _mm512_srli_epi64(at, 6), words, 8);
    return _mm512_testn_epi64_mask(_mm512_rorv_epi64(word, at), _mm512_set1_epi64(1));
  }
  FRONTLUX_COMMON_AVX512
};
