#pragma once

#include <frontlux/ray.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// A record's bytes that do not say what they should; without the file and the place in it.
class BadRecord : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The bytes of a record, to be written or to be read. Each method writes a value, or reads it; so one
/// function says what a record consists of, and both check the same: a value that could not be read again is
/// not written either.
///
/// Whole numbers are varints: 7 bits a byte, the lowest first, the highest bit set in all but the last byte.
/// Other numbers are IEEE doubles, lowest byte first.
class RecordBytes {
 public:
  /// To write: all values that follow are appended.
  RecordBytes() = default;
  /// To read: all values that follow come from here. Nothing is allocated for what the bytes do not hold.
  explicit RecordBytes(std::string_view bytes) : reading_(true), left_(bytes) {}

  [[nodiscard]] const std::string& written() const { return written_; }
  /// @throws BadRecord unless all bytes were read
  void end() const;

  /// What the values that follow belong to, in messages.
  void part(std::string name) { part_ = std::move(name); }
  /// @throws std::invalid_argument (writing) or BadRecord (reading) naming the part, unless it holds. So do
  /// all the others where a value is out of bounds, and where the bytes end too early
  void require(bool holds, const char* what) const {
    if (!holds) refuse(what);
  }

  /// A whole number, a flag or an enumeration: from 0 to `max`.
  template <class Whole>
  void whole(Whole& value, const char* name = "",
             std::uint64_t max = std::numeric_limits<std::uint64_t>::max()) {
    auto number = static_cast<std::uint64_t>(value);
    varint(number);
    if (number > max) refuse(out_of_range(name, number, max));
    value = static_cast<Whole>(number);
  }
  /// An enumeration, up to the greatest of its values.
  template <class Enumeration>
  requires std::is_enum_v<Enumeration>
  void whole(Enumeration& value, const char* name, Enumeration greatest) {
    whole(value, name, static_cast<std::uint64_t>(greatest));
  }
  void number(double& value);
  void text(std::string& text);
  void key(VoxelKey& key) {
    for (const auto axis : kAxes) whole(key.*axis, "a voxel's key", 0xFFFF);
  }

  /// How many elements a list has, each of at least so many bytes.
  template <class List>
  void length(List& list, std::size_t least_bytes) {
    std::uint64_t size = list.size();
    varint(size);
    if (!reading_) return;
    require(size <= left_.size() / least_bytes, "a list is longer than what is there");
    list.resize(static_cast<std::size_t>(size));
  }
  /// length() of a list that has from `fewest` to `most` elements, else `what` is wrong.
  template <class List>
  void length(List& list, std::size_t fewest, std::size_t most, const char* what) {
    std::uint64_t size = list.size();
    varint(size);
    require(size >= fewest && size <= most, what);
    if (reading_) list.resize(static_cast<std::size_t>(size));
  }

  /// A value that may be missing; `code` writes or reads it.
  template <class Value, class Code>
  void maybe(std::optional<Value>& value, const Code& code) {
    bool there = value.has_value();
    whole(there, "a flag", 1);
    if (!there)
      value.reset();
    else
      code(value ? *value : value.emplace());
  }

  /// The key of each element, as differences from the one before: of x for all, then of y, then of z.
  template <class Element, class Key = std::identity>
  void keys(std::vector<Element>& list, const Key& key = {}) {
    for (const auto axis : kAxes) {
      int last = 0;
      for (Element& element : list) difference(std::invoke(key, element).*axis, last);
    }
  }

  /// A number of each element: the highest byte of all, then the next lower one. Numbers that are close have
  /// long runs of equal bytes then.
  template <class Element>
  void numbers(std::vector<Element>& list, double Element::*number) {
    if (!reading_) {
      for (unsigned shift = 64; shift > 0; shift -= 8)
        for (const Element& e : list) written_ += byte_of(e.*number, shift - 8);
      return;
    }
    const std::string_view planes = take(8 * list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      std::uint64_t bits = 0;
      for (std::size_t byte = 0; byte < 8; ++byte)
        bits = (bits << 8U) | static_cast<unsigned char>(planes[byte * list.size() + i]);
      list[i].*number = std::bit_cast<double>(bits);
    }
  }

 private:
  static constexpr std::array kAxes = {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z};

  void varint(std::uint64_t& value);
  void difference(std::uint16_t& value, int& last);
  std::string_view take(std::size_t size);
  static char byte_of(double number, unsigned shift);
  static std::string out_of_range(const char* name, std::uint64_t value, std::uint64_t max);
  [[noreturn]] void refuse(const std::string& what) const;

  bool reading_ = false;
  std::string_view left_;  // to read
  std::string written_, part_;
};

}  // namespace frontlux::planner::detail
