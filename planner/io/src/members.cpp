#include "members.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/spelling.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

namespace frontlux::io {
namespace {

using nlohmann::json;

std::string describe(const char* unit, const Range& range) {
  const std::string end = *unit == '\0' ? "" : std::string(" ") + unit;
  if (range.low == kAboveZero.low && range.high < kAboveZero.high)
    return "a number above 0" + end + ", at most " + decimals_of(range.high) + end;
  if (range.high < kAboveZero.high)
    return "a number from " + decimals_of(range.low) + " to " + decimals_of(range.high) + end;
  return (range.low == kAboveZero.low ? "a number above 0"
                                      : "a number of at least " + decimals_of(range.low)) +
         end;
}

// "line 3, column 7"
std::string place_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte == 0 ? 0 : byte - 1);
  const auto line = 1 + std::ranges::count(before, '\n');
  const std::size_t begin = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  return "line " + std::to_string(line) + ", column " + std::to_string(before.size() - begin + 1);
}

}  // namespace

json read_json(const std::filesystem::path& file, const JsonContent& content) {
  std::error_code no_size;
  const std::uintmax_t size = std::filesystem::file_size(file, no_size);
  if (!no_size && size > content.most_bytes)
    fail(file, "has " + std::to_string(size) + " bytes, too many for " + content.what,
         "give a description of at most " + std::to_string(content.most_bytes) + " bytes");
  json object = parse_json(file, read_file(file), content);
  if (!object.is_object())
    fail(file, "holds " + Members::shown(object) + " and no object",
         std::string("describe ") + content.what + " between { and }, see " + content.page);
  return object;
}

json parse_json(const std::filesystem::path& file, const std::string& text, const JsonContent& content) {
  // The parser takes one for the end.
  if (const std::size_t nul = text.find('\0'); nul != std::string::npos)
    fail(file, place_of(text, nul + 1) + ": there is a NUL byte, which is not JSON",
         "save the file as plain text");
  std::vector<std::set<std::string>> names;  // of the objects that are open
  std::string last = "the file";
  const auto look = [&](int depth, json::parse_event_t event, json& value) {
    const auto level = static_cast<std::size_t>(depth);
    switch (event) {
      case json::parse_event_t::object_start:
      case json::parse_event_t::array_start:
        if (level >= content.depth)
          fail(file, last + " is nested too deeply",
               std::string("see ") + content.page + " for the members of " + content.what);
        names.resize(level + 1);
        names.back().clear();
        break;
      case json::parse_event_t::key: {
        const auto& name = value.get_ref<const std::string&>();
        last = quote(name);
        if (!names.back().insert(name).second)
          fail(file, "the member " + last + " is there twice", "keep one of them");
        break;
      }
      case json::parse_event_t::object_end:
      case json::parse_event_t::array_end:
        names.resize(level);
        break;
      case json::parse_event_t::value:
        break;
    }
    return true;
  };
  try {
    return json::parse(text, look);
  } catch (const json::parse_error& error) {
    if (text.empty()) fail(file, "is empty", "write a JSON object");
    fail(file, place_of(text, error.byte) + ": this is not JSON (after " + last + ")",
         "look for a missing comma, quote or bracket; NaN, infinity and comments are not JSON");
  } catch (const json::out_of_range&) {
    fail(file, "a number is too large, in or after " + last, "give a smaller one");
  }
}

Members::Members(const std::filesystem::path& file, const json& object, std::string prefix)
    : file_(file), object_(object), prefix_(std::move(prefix)) {}

void Members::refuse(const std::string& sentence) const {
  throw std::runtime_error(file_.string() + ": " + prefix_ + sentence);
}

void Members::refuse(const std::string& name, const std::string& what, const std::string& advice) const {
  fail(file_, prefix_ + name + " " + what, advice);
}

void Members::refuse_value(const std::string& name, const json& value, const std::string& wanted) const {
  refuse(name, "is " + shown(value), "give " + wanted);
}

const json* Members::find(const std::string& name) {
  if (std::ranges::find(known_, name) == known_.end()) known_.push_back(name);
  const auto member = object_.find(name);
  return member == object_.end() ? nullptr : &*member;
}

const json& Members::get(const std::string& name, const std::string& wanted) {
  if (const json* member = find(name)) return *member;
  std::vector<std::string> others;
  for (const auto& [other, value] : object_.items())
    if (std::ranges::find(known_, other) == known_.end()) others.push_back(other);
  const auto misspelt = meant_by(name, others);
  refuse(name, misspelt ? "is missing, unless " + quote(*misspelt) + " is meant to be it" : "is missing",
         "give " + wanted);
}

std::string Members::text(const std::string& name, const std::string& wanted) {
  const json& value = get(name, wanted);
  if (!value.is_string()) refuse_value(name, value, wanted);
  if (value.get_ref<const std::string&>().find('\0') != std::string::npos)  // the end of any file's name
    refuse(name, "holds a NUL character", "give " + wanted);
  return value.get<std::string>();
}

double Members::number(const std::string& name, const char* unit, const Range& range) {
  return number(name, get(name, describe(unit, range)), unit, range);
}

double Members::number(const std::string& name, const char* unit, const Range& range, double otherwise) {
  const json* value = find(name);
  return value == nullptr ? otherwise : number(name, *value, unit, range);
}

double Members::number(const std::string& name, const json& value, const char* unit,
                       const Range& range) const {
  const bool fits =
      value.is_number() && value.get<double>() >= range.low && value.get<double>() <= range.high;
  if (!fits) refuse_value(name, value, describe(unit, range));
  return value.get<double>();
}

std::vector<double> Members::numbers(const std::string& name, const json& value, std::size_t size,
                                     const std::string& wanted, const char* unit, const Range& range) const {
  if (!value.is_array() || value.size() != size) refuse_value(name, value, wanted);
  std::vector<double> all;
  for (std::size_t i = 0; i < size; ++i) all.push_back(number(element(name, i), value[i], unit, range));
  return all;
}

std::string Members::element(const std::string& name, std::size_t index) {
  return name + "[" + std::to_string(index) + "]";
}

std::uint64_t Members::whole(const std::string& name, std::uint64_t low, std::uint64_t high) {
  const std::string wanted = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  const json& value = get(name, wanted);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() < low || value.get<std::uint64_t>() > high)
    refuse_value(name, value, wanted);
  return value.get<std::uint64_t>();
}

bool Members::flag(const std::string& name, bool otherwise) {
  const json* value = find(name);
  if (value != nullptr && !value->is_boolean()) refuse_value(name, *value, "true or false");
  return value == nullptr ? otherwise : value->get<bool>();
}

Members Members::object(const std::string& name, const std::string& wanted) {
  return object(name, get(name, wanted), wanted);
}

Members Members::object(const std::string& name, const json& value, const std::string& wanted) const {
  if (!value.is_object()) refuse_value(name, value, wanted);
  return {file_, value, prefix_ + name + "."};
}

void Members::not_here(std::initializer_list<const char*> names, const std::string& why) const {
  for (const char* name : names)
    if (object_.contains(name)) refuse(name, why, "leave it out");
}

void Members::expect_no_more() const {
  for (const auto& [name, value] : object_.items()) {
    if (std::ranges::find(known_, name) != known_.end()) continue;
    std::string all;
    for (const std::string& one : known_) all += (all.empty() ? "" : ", ") + one;
    const auto meant = meant_by(name, known_);
    const std::string guess = meant ? " (did you mean " + *meant + "?)" : "";
    fail(file_, "the member " + quote(prefix_ + name) + " is not known" + guess, "known here: " + all);
  }
}

std::string Members::shown(const json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_string()) return quote(value.get_ref<const std::string&>());
  return value.dump();
}

double degrees_of(double radians) {
  const double degrees = radians / kDegree;
  constexpr int kDigits = 12;
  std::array<char, 32> text{};
  const auto written =
      std::to_chars(text.data(), text.data() + text.size(), degrees, std::chars_format::general, kDigits);
  double rounded = degrees;
  std::from_chars(text.data(), written.ptr, rounded);
  for (const double near :
       {rounded, degrees, std::nextafter(degrees, -1e300), std::nextafter(degrees, 1e300)})
    if (near * kDegree == radians) return near;
  return degrees;
}

}  // namespace frontlux::io
