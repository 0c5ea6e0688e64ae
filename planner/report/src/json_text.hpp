#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace frontlux::report::detail {

/// Builds a JSON text value by value; commas come by themselves.
class JsonText {
 public:
  JsonText& open(char bracket);  ///< '{' or '['
  JsonText& close(char bracket);
  JsonText& name(std::string_view name);
  JsonText& text(std::string_view text);
  /// The shortest decimals that read back as the same number; null if it is not finite.
  JsonText& number(double number);
  JsonText& number(std::uint64_t number);
  JsonText& yes(bool yes);
  JsonText& null();

  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  void separate();

  std::string text_;
};

}  // namespace frontlux::report::detail
