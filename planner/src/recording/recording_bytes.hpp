#pragma once

#include <frontlux/ray.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::planner::detail {

/// A record's bytes that do not say what they should; without the file and the place in it.
class BadRecord : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The bytes of a record, as they are appended. `RecordReader` has the same methods with the same names, so
/// that one function template says what a record consists of, and both check the same: a value that could not
/// be read again is not written either.
///
/// Counts are varints: 7 bits a byte, the lowest first, the highest bit set in all but the last byte. Other
/// numbers are IEEE doubles, lowest byte first.
class RecordWriter {
 public:
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

  /// What the values that follow belong to, in messages.
  void part(std::string name) { part_ = std::move(name); }
  /// @throws std::invalid_argument naming the part, unless it holds
  void require(bool holds, const char* what) const {
    if (!holds) refuse(what);
  }

  void count(std::uint64_t value);
  void number(double value);
  void text(const std::string& text);
  void flag(bool flag) { bytes_ += flag ? '\1' : '\0'; }
  void count32(std::uint32_t value) { count(value); }
  void small(int value, int max, const char* name);

  /// One of the first `choices` values of an enumeration.
  template <class Enum>
  void choice(Enum value, int choices, const char* name) {
    small(static_cast<int>(value), choices - 1, name);
  }

  /// How many follow, each of at least so many bytes.
  template <class List>
  void length(const List& list, std::size_t /*least_bytes*/) {
    count(list.size());
  }

  template <class Value, class Code>
  void maybe(const std::optional<Value>& value, const Code& code) {
    flag(value.has_value());
    if (value) code(*value);
  }

  void key(const VoxelKey& key);

  /// A key of each element, as differences from the one before: of x for all, then of y, then of z.
  template <class Element>
  void keys(const std::vector<Element>& list, VoxelKey Element::*key) {
    column(list, [&](const Element& e) { return (e.*key).x; });
    column(list, [&](const Element& e) { return (e.*key).y; });
    column(list, [&](const Element& e) { return (e.*key).z; });
  }
  void keys(const std::vector<VoxelKey>& list) {
    column(list, [](const VoxelKey& k) { return k.x; });
    column(list, [](const VoxelKey& k) { return k.y; });
    column(list, [](const VoxelKey& k) { return k.z; });
  }

  /// A number of each element: the highest byte of all, then the next lower one. Close numbers have long
  /// runs of equal bytes then.
  template <class Element>
  void numbers(const std::vector<Element>& list, double Element::*number) {
    for (int byte = 7; byte >= 0; --byte)
      for (const Element& e : list) bytes_ += byte_of(e.*number, byte);
  }

 private:
  template <class List, class Coordinate>
  void column(const List& list, const Coordinate& coordinate) {
    int last = 0;
    for (const auto& element : list) {
      const int next = coordinate(element);
      difference(next - last);
      last = next;
    }
  }
  void difference(int value) {  // 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
    count(value < 0 ? 2 * static_cast<std::uint64_t>(-value) - 1 : 2 * static_cast<std::uint64_t>(value));
  }
  static char byte_of(double number, int byte);
  [[noreturn]] void refuse(const std::string& what) const;

  std::string bytes_, part_;
};

/// Takes a record's bytes apart. Nothing is allocated for what the bytes do not hold.
class RecordReader {
 public:
  explicit RecordReader(std::string_view bytes) : left_(bytes) {}

  /// @throws BadRecord unless all bytes were taken
  void end() const;

  void part(std::string name) { part_ = std::move(name); }
  void require(bool holds, const char* what) const {
    if (!holds) refuse(what);
  }

  /// @throws BadRecord if the bytes end too early or say what cannot be; so do all the others
  template <class Count>
  void count(Count& value) {
    static_assert(sizeof(Count) == 8);
    value = take_count();
  }
  void number(double& value);
  void text(std::string& text);
  void flag(bool& flag);
  void count32(std::uint32_t& value);
  void small(int& value, int max, const char* name);

  template <class Enum>
  void choice(Enum& value, int choices, const char* name) {
    int number = 0;
    small(number, choices - 1, name);
    value = static_cast<Enum>(number);
  }

  template <class List>
  void length(List& list, std::size_t least_bytes) {
    const std::uint64_t size = take_count();
    if (size > left_.size() / least_bytes) refuse("a list is longer than what is there");
    list.resize(static_cast<std::size_t>(size));
  }

  template <class Value, class Code>
  void maybe(std::optional<Value>& value, const Code& code) {
    bool there = false;
    flag(there);
    value.reset();
    if (there) code(value.emplace());
  }

  void key(VoxelKey& key);

  template <class Element>
  void keys(std::vector<Element>& list, VoxelKey Element::*key) {
    column(list, [&](Element& e) -> std::uint16_t& { return (e.*key).x; });
    column(list, [&](Element& e) -> std::uint16_t& { return (e.*key).y; });
    column(list, [&](Element& e) -> std::uint16_t& { return (e.*key).z; });
  }
  void keys(std::vector<VoxelKey>& list) {
    column(list, [](VoxelKey& k) -> std::uint16_t& { return k.x; });
    column(list, [](VoxelKey& k) -> std::uint16_t& { return k.y; });
    column(list, [](VoxelKey& k) -> std::uint16_t& { return k.z; });
  }

  template <class Element>
  void numbers(std::vector<Element>& list, double Element::*number) {
    const std::string_view planes = take(8 * list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      std::uint64_t bits = 0;
      for (std::size_t byte = 0; byte < 8; ++byte)
        bits = (bits << 8U) | static_cast<unsigned char>(planes[byte * list.size() + i]);
      list[i].*number = from_bits(bits);
    }
  }

 private:
  template <class List, class Coordinate>
  void column(List& list, const Coordinate& coordinate) {
    std::int64_t last = 0;
    for (auto& element : list) {
      last += difference();
      if (last < 0 || last > 0xFFFF) refuse("a voxel lies outside the key range");
      coordinate(element) = static_cast<std::uint16_t>(last);
    }
  }
  std::uint64_t take_count();
  std::int64_t difference();
  std::string_view take(std::size_t size);
  static double from_bits(std::uint64_t bits);
  [[noreturn]] void refuse(const std::string& what) const;

  std::string_view left_;
  std::string part_;
};

}  // namespace frontlux::planner::detail
