#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace frontlux::io {

/// The numbers that a member takes, both ends included.
struct Range {
  double low, high;
};
inline constexpr Range kAboveZero{std::numeric_limits<double>::denorm_min(),
                                  std::numeric_limits<double>::max()};
inline constexpr Range kFromZero{0.0, std::numeric_limits<double>::max()};
inline constexpr Range kLengths{0.01, 100.0};                // [m] of bodies
inline constexpr Range kCoordinates{-1e9, 1e9};              // [m] as of meshes
inline constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]

/// What a JSON file is to hold.
struct JsonContent {
  const char* what;   ///< "a robot"
  const char* page;   ///< that describes it: "docs/robots.md"
  std::size_t depth;  ///< of nested objects and arrays
  std::uintmax_t most_bytes = std::uintmax_t{1} << 20;
};

/// The object that a file holds. No object in it has a member twice.
/// @throws std::runtime_error naming the file, the place and what to do
[[nodiscard]] nlohmann::json read_json(const std::filesystem::path& file, const JsonContent& content);
[[nodiscard]] nlohmann::json parse_json(const std::filesystem::path& file, const std::string& text,
                                        const JsonContent& content);

/// One object of a JSON file. Its members are taken one by one; what is left in the end is not known. Each
/// complaint is a std::runtime_error with the file, the member, its value, and what to give instead.
class Members {
 public:
  /// @param file, object  live as long as this
  /// @param prefix        of the members' names in messages: "sensor."
  Members(const std::filesystem::path& file, const nlohmann::json& object, std::string prefix = "");

  /// "file: sentence", which begins with a member's name.
  [[noreturn]] void refuse(const std::string& sentence) const;
  /// "file: name what; advice"
  [[noreturn]] void refuse(const std::string& name, const std::string& what, const std::string& advice) const;
  /// "file: name is <value>; give ..."
  [[noreturn]] void refuse_value(const std::string& name, const nlohmann::json& value,
                                 const std::string& wanted) const;

  /// Null if there is no such member.
  [[nodiscard]] const nlohmann::json* find(const std::string& name);
  [[nodiscard]] const nlohmann::json& get(const std::string& name, const std::string& wanted);

  [[nodiscard]] std::string text(const std::string& name, const std::string& wanted);
  [[nodiscard]] double number(const std::string& name, const char* unit, const Range& range);
  [[nodiscard]] double number(const std::string& name, const char* unit, const Range& range,
                              double otherwise);
  [[nodiscard]] double number(const std::string& name, const nlohmann::json& value, const char* unit,
                              const Range& range) const;
  /// An array of exactly so many numbers. A message names the one that is wrong.
  [[nodiscard]] std::vector<double> numbers(const std::string& name, const nlohmann::json& value,
                                            std::size_t size, const std::string& wanted, const char* unit,
                                            const Range& range) const;
  [[nodiscard]] std::uint64_t whole(const std::string& name, std::uint64_t low, std::uint64_t high);
  [[nodiscard]] bool flag(const std::string& name, bool otherwise);
  /// A member that is an object.
  [[nodiscard]] Members object(const std::string& name, const std::string& wanted);
  [[nodiscard]] Members object(const std::string& name, const nlohmann::json& value,
                               const std::string& wanted) const;

  /// None of these members may be given here.
  void not_here(std::initializer_list<const char*> names, const std::string& why) const;
  /// All members have been asked for.
  void expect_no_more() const;

  /// A value in a message.
  [[nodiscard]] static std::string shown(const nlohmann::json& value);
  /// "name[index]"
  [[nodiscard]] static std::string element(const std::string& name, std::size_t index);

 private:
  const std::filesystem::path& file_;
  const nlohmann::json& object_;
  std::string prefix_;
  std::vector<std::string> known_;
};

/// The degrees that are read back as these radians, in few digits where that can be.
[[nodiscard]] double degrees_of(double radians);

}  // namespace frontlux::io
