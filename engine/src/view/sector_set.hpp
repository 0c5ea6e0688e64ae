#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace frontlux::detail {

/// Some of the sectors of the horizon in which visible targets are counted, the azimuth bins. More than 64
/// bins are told apart in 64 parts only: with one of a part all of it is in the set.
class SectorSet {
 public:
  static constexpr int kParts = 64;  ///< that are told apart
  constexpr SectorSet() = default;   ///< none
  [[nodiscard]] static constexpr SectorSet all() { return SectorSet(~std::uint64_t{0}); }
  /// One of so many bins.
  [[nodiscard]] static constexpr SectorSet of(int bin, int bins) {
    return SectorSet(std::uint64_t{1} << part(bin, bins));
  }
  /// All from one bin to another, counted upwards and from the last on to 0.
  [[nodiscard]] static constexpr SectorSet between(int first, int last, int bins) {
    const std::uint64_t up_to_last = ~std::uint64_t{0} >> (kParts - 1 - part(last, bins));
    const std::uint64_t from_first = ~std::uint64_t{0} << part(first, bins);
    return SectorSet(first <= last ? from_first & up_to_last : from_first | up_to_last);
  }

  /// All bins of one of the parts that can be told apart.
  [[nodiscard]] static constexpr SectorSet of_part(int part) { return SectorSet(std::uint64_t{1} << part); }

  [[nodiscard]] constexpr bool any() const { return bits_ != 0; }
  /// Whether all sectors of another set are in this one.
  [[nodiscard]] constexpr bool contains(SectorSet other) const { return (other.bits_ & ~bits_) == 0; }
  /// Of parts.
  [[nodiscard]] constexpr int size() const { return std::popcount(bits_); }
  constexpr void remove(SectorSet other) { bits_ &= ~other.bits_; }
  [[nodiscard]] constexpr bool meets(SectorSet other) const { return (other.bits_ & bits_) != 0; }
  constexpr SectorSet& operator|=(SectorSet other) {
    bits_ |= other.bits_;
    return *this;
  }
  friend constexpr bool operator==(SectorSet, SectorSet) = default;

  /// Sets the numbers of these sectors to 0. @param numbers  one for each bin
  void clear(std::span<std::uint32_t> numbers) const {
    const int bins = static_cast<int>(numbers.size());
    for (int bin = 0; bin < bins; ++bin)
      if (contains(of(bin, bins))) numbers[static_cast<std::size_t>(bin)] = 0;
  }

 private:
  explicit constexpr SectorSet(std::uint64_t bits) : bits_(bits) {}
  static constexpr int part(int bin, int bins) { return bins <= kParts ? bin : bin * kParts / bins; }

  std::uint64_t bits_ = 0;
};

}  // namespace frontlux::detail
