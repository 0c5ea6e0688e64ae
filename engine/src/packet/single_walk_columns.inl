// Included by single_walk.cpp after single_walk_body.inl, compiled for AVX-512.

// Fifteen columns of a ray, a lane to each: what lies between two crossings of the axis that it crosses most
// often, the main one. There it crosses each other axis at most once, so it is in up to three voxels: one at
// the column's start, one at its end, and where it crosses both, one between. All are looked up together.
class Columns {
 public:
  Columns(const OpenVoxels& table, const Times& times, std::uint32_t flip, int too_close)
      : table_(table), flip_(static_cast<int>(flip)), too_close_(too_close) {
    const PerAxis d = times.between;
    main_ = d[0] < d[1] ? 0U : 1U;
    if (d[2] < d[main_]) main_ = 2;
    crossings_ = _mm512_mullo_epi32(numbers(), all(d[main_]));
    one_ = OtherAxis(times, main_ == 0 ? 1U : 0U);
    two_ = OtherAxis(times, main_ == 2 ? 1U : 2U);
  }

  // As `Steps::walk_on`.
  std::uint32_t walk_on(PerAxis& t, std::uint32_t& index) const {
    const __m512i next = _mm512_castsi128_si512(std::bit_cast<__m128i>(t));
    // When each column is. Numbers overflow in lanes behind one that is late.
    const __m512i over = _mm512_add_epi32(lane(next, main_), crossings_);
    const Course one = course(one_, next, over, index), two = course(two_, next, over, index);
    const __m512i along = parts(main_, index);
    const __mmask16 one_first = _mm512_cmplt_epi32_mask(one.crossed, two.crossed);
    const __m512i at_start = either(along, one.at_start, two.at_start);
    const __m512i at_end = either(along, one.at_end, two.at_end);
    const __m512i between = either(along, _mm512_mask_mov_epi32(one.at_start, one_first, one.at_end),
                                   _mm512_mask_mov_epi32(two.at_end, one_first, two.at_start));

    const auto both = static_cast<__mmask16>(one.crosses & two.crosses);
    const __mmask16 tie = _mm512_mask_cmple_epi32_mask(
        both, _mm512_abs_epi32(_mm512_sub_epi32(one.crossed, two.crossed)), all(too_close_));
    const auto closed_start = closed(at_start);  // the last is where the next columns begin
    const auto closed_between = static_cast<__mmask16>(closed(between) & kColumns);
    const auto closed_end = static_cast<__mmask16>(closed(at_end) & kColumns);
    const unsigned unclear = (one.unclear | two.unclear | tie) & kColumns;
    const unsigned late =
        static_cast<unsigned>(_mm512_cmpgt_epi32_mask(over, all(kEndOfTime))) << 1U & 0xFFFFU;
    const unsigned ends = closed_start | closed_between | closed_end | unclear | late;
    if (ends == 0) {
      t[main_] = last(over);
      t[one_.axis] = last(one.crossed);
      t[two_.axis] = last(two.crossed);
      index = static_cast<std::uint32_t>(last(at_start) ^ flip_);
      return kWalksOn;
    }
    const unsigned first = ends & -ends;
    if ((first & late) != 0) return kWentThrough;
    if ((first & unclear) != 0) return kTooCloseToTell;
    const __m512i sooner = _mm512_min_epi32(one.crossed, two.crossed);
    const __m512i later = _mm512_mask_max_epi32(sooner, both, one.crossed, two.crossed);
    __m512i entered = _mm512_mask_mov_epi32(later, closed_between, sooner);
    __m512i stop = _mm512_mask_mov_epi32(at_end, closed_between, between);
    entered = _mm512_mask_mov_epi32(entered, closed_start, _mm512_setzero_si512());  // it is not late
    stop = _mm512_mask_mov_epi32(stop, closed_start, at_start);
    if ((first & _mm512_cmpgt_epi32_mask(entered, all(kEndOfTime))) != 0) return kWentThrough;
    return static_cast<std::uint32_t>(
        _mm512_cvtsi512_si32(_mm512_maskz_compress_epi32(static_cast<__mmask16>(first), stop)));
  }

 private:
  static constexpr unsigned kColumns = 0x7FFF;

  // One that is not the main one.
  struct OtherAxis {
    OtherAxis() = default;
    OtherAxis(const Times& times, std::size_t a) : axis(a), never(times.first[a] > kEndOfTime) {
      // Later than any time, so that nothing comes close to the crossing before.
      const int d = never ? std::numeric_limits<int>::max() : times.between[a];
      between = all(d);
      rate = _mm512_set1_ps(1.0F / static_cast<float>(d));
    }
    std::size_t axis;
    bool never;  // does the ray cross it in its time
    __m512i between;
    __m512 rate;
  };
  // What comes of it in each column.
  struct Course {
    __m512i crossed;           // when, for the first time since the column's start
    __m512i at_start, at_end;  // its part of the index
    __mmask16 crosses;
    __mmask16 unclear;  // it, or the main one first
  };

  static __m512i all(int value) { return _mm512_set1_epi32(value); }
  static __m512i numbers() { return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15); }
  static __m512i lane(__m512i v, std::size_t number) {
    return _mm512_permutexvar_epi32(all(static_cast<int>(number)), v);
  }
  // Each lane's value in the next one, and another in the first.
  static __m512i moved_on(__m512i v, __m512i into_first) { return _mm512_alignr_epi32(v, into_first, 15); }
  static int last(__m512i v) { return _mm_extract_epi32(_mm512_extracti32x4_epi32(v, 3), 3); }
  static __m512i either(__m512i a, __m512i b, __m512i c) { return _mm512_ternarylogic_epi32(a, b, c, 0xFE); }

  // An axis' part of the table's index, as many steps on as the lane's number.
  [[nodiscard]] __m512i parts(std::size_t a, std::uint32_t index) const {
    const std::uint32_t bits = table_.layout().bits[a];
    const __m128i shift = _mm_cvtsi32_si128(static_cast<int>(table_.layout().shift(a)));
    const __m512i steps = _mm512_or_si512(_mm512_slli_epi32(_mm512_and_si512(numbers(), all(7)), kLowBit[a]),
                                          _mm512_sll_epi32(_mm512_srli_epi32(numbers(), 3), shift));
    const __m512i moved = _mm512_add_epi32(all(static_cast<int>(index | ~bits)), steps);
    return _mm512_and_si512(_mm512_xor_si512(moved, all(flip_)), all(static_cast<int>(bits)));
  }

  // @param next  when the ray crosses each axis next
  // @param over  when each column is over
  [[nodiscard]] Course course(const OtherAxis& other, __m512i next, __m512i over, std::uint32_t index) const {
    const __m512i t = other.never ? all(kNever) : lane(next, other.axis);
    const __m512 since = _mm512_cvtepi32_ps(_mm512_sub_epi32(over, t));
    // If rounding counts one too many or too few, it is as close to the column's end as that is unclear.
    const __m512i crossings =
        _mm512_add_epi32(all(1), _mm512_cvt_roundps_epi32(_mm512_mul_ps(since, other.rate),
                                                          _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC));
    const __m512i crossed_next = _mm512_add_epi32(t, _mm512_mullo_epi32(crossings, other.between));
    const __m512i left = _mm512_sub_epi32(crossed_next, over), margin = all(too_close_ + 1);
    const __mmask16 unclear = _mm512_cmpgt_epu32_mask(
        _mm512_sub_epi32(left, margin), _mm512_sub_epi32(other.between, _mm512_add_epi32(margin, margin)));
    const __m512i before = moved_on(crossings, _mm512_setzero_si512());
    const __m512i part = parts(other.axis, index);
    return {moved_on(crossed_next, t), _mm512_permutexvar_epi32(before, part),
            _mm512_permutexvar_epi32(crossings, part), _mm512_cmpneq_epi32_mask(before, crossings), unclear};
  }

  // Behind the ray's end they may lie beyond the table.
  [[nodiscard]] __mmask16 closed(__m512i index) const {
    const __m512i at =
        _mm512_min_epu32(_mm512_srli_epi32(index, 5), all(static_cast<int>(table_.last() >> 5U)));
    const __m512i word = _mm512_i32gather_epi32(at, table_.words(), 4);
    return _mm512_testn_epi32_mask(_mm512_rorv_epi32(word, index), all(1));
  }

  const OpenVoxels& table_;
  int flip_, too_close_;
  std::size_t main_;
  __m512i crossings_;  // of the main axis, from the next one on: when each lane's is
  OtherAxis one_, two_;
};
