#pragma once

#include "read_value.hpp"
#include "text.hpp"

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace frontlux::app {

/// An option of a command, valid as long as the command line.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option& required();
  Option& excludes(const Option& other);
  /// Whether it stands on the command line. @pre that has been read
  [[nodiscard]] bool given() const;

 private:
  friend class Command;
  CLI::Option* option_;
};

/// A subcommand of `frontlux`: CLI11's, with values that are typed and checked when they are read (see
/// `read`; CLI11's own conversions let nan, inf and hexadecimal numbers through). CLI11 itself is seen by few
/// source files, since it takes long to compile.
class Command {
 public:
  using ReadWord = std::function<void(std::string_view word)>;

  /// @param summary  what it does, in an imperative sentence without a full stop
  Command(CLI::App& app, const char* name, const char* summary);

  enum class Shown { kAlways, kInHelpAll };
  /// The heading in --help of the options that are added from now on, and whether only --help-all shows them.
  void group(const char* heading, Shown shown = Shown::kAlways) {
    group_ = heading;
    shown_ = shown;
  }

  /// Adds an option, or a positional argument if the name does not begin with a dash. What `value` holds now
  /// is the default, and shown in --help.
  /// @param value  lives as long as the command line; a vector takes the option any number of times
  /// @param type   what to write for the value in --help: "METRES"
  /// @param limits of a number: a Range
  template <class Value, class... Limits>
  Option add(const char* name, Value& value, const char* type, const char* what, const Limits&... limits) {
    return add_words(name, type, what, default_text(value), is_vector(value),
                     [&value, limits...](std::string_view word) { read(word, value, limits...); });
  }
  /// The same for one of the names of `kChoices`, which --help lists.
  template <Chosen Value>
  Option add(const char* name, Value& value, const char* what) {
    return add(name, value, names_of<Value>().c_str(), what);
  }
  template <Chosen Value>
  Option add(const char* name, std::optional<Value>& value, const char* what) {
    return add(name, value, names_of<Value>().c_str(), what);
  }
  /// An option whose word a function takes, before the values of the options that are added after it.
  Option add_action(const char* name, const char* type, const char* what, ReadWord read_word);
  /// A switch without a value.
  Option add_flag(const char* name, bool& value, const char* what);

  /// Exactly one of the two has to be given.
  void require_one(Option& one, Option& other);
  /// Nothing but these may be given beside an option.
  void allow_only(Option& option, std::initializer_list<std::string_view> others);

  /// Reads a word as the value of an option, by its name without dashes. May be called when the command
  /// itself is gone, as long as the command line is there.
  using ReadOption = std::function<void(const std::string& name, std::string_view word)>;
  [[nodiscard]] ReadOption read_option() const;

  /// Shown below the options.
  void examples(const char* text);
  /// What the command does, once all its options are read.
  void run(std::function<void()> work);

 private:
  Option add_words(const char* name, const char* type, const char* what, const std::string& default_text,
                   bool repeatable, ReadWord read_word);

  template <class Value>
  static std::string default_text(const Value& value) {
    if constexpr (Chosen<Value>)
      return std::string(choice_name(value));
    else if constexpr (std::is_arithmetic_v<Value>)
      return to_text(value);
    else if constexpr (std::is_same_v<Value, std::string>)
      return value;
    else
      return {};
  }
  template <class Value>
  static constexpr bool is_vector(const Value&) {
    return false;
  }
  template <class Value>
  static constexpr bool is_vector(const std::vector<Value>&) {
    return true;
  }
  template <class Value>
  static std::string names_of() {
    std::string names;
    for (const auto& choice : kChoices<Value>) names.append(names.empty() ? "" : "|").append(choice.name);
    return names;
  }

  void show(CLI::Option& option) const;

  CLI::App* app_;
  std::string group_ = "Options";
  Shown shown_ = Shown::kAlways;
  std::vector<std::function<void()>> checks_;
};

}  // namespace frontlux::app
