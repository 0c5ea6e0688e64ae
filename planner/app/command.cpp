#include "command.hpp"

#include "help.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <utility>

namespace frontlux::app {

Option& Option::required() {
  option_->required();
  return *this;
}
Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

bool Option::given() const { return option_->count() > 0; }

Command::Command(CLI::App& app, const char* name, const char* summary)
    : app_(app.add_subcommand(name, summary)) {}

namespace {

std::string see_help(const CLI::App& app) { return "; see frontlux " + app.get_name() + " --help"; }

}  // namespace

constexpr int kMostWords = 1 << 20;  // of a positional argument that may be repeated

Option Command::add_words(const char* name, const char* type, const char* what,
                          const std::string& default_text, bool repeatable, ReadWord read_word) {
  const std::string label = std::string_view(name).substr(std::string_view(name).rfind(',') + 1).data();
  CLI::Option* option = app_->add_option(
      name,
      [label, type = std::string(type), help = see_help(*app_),
       read_word = std::move(read_word)](const CLI::results_t& words) {
        for (const std::string& word : words) {
          check_name(label, word, type);
          try {
            read_word(word);
          } catch (const BadInput& error) {
            const std::string_view said = error.what();  // of an option in a task: with the advice
            throw BadInput(label + ": " + error.what() + (said.ends_with(help) ? "" : help));
          }
        }
        return true;
      },
      what);
  option->type_name(type)->default_str(default_text);
  show(*option);
  if (repeatable && option->get_positional())
    option->expected(1, kMostWords)->allow_extra_args();
  else if (repeatable)
    option->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return Option(option);
}

Option Command::add_flag(const char* name, bool& value, const char* what) {
  CLI::Option* option = app_->add_flag(name, value, what);
  show(*option);
  return Option(option);
}

void Command::show(CLI::Option& option) const {
  option.group(group_);
  if (shown_ == Shown::kInHelpAll) dynamic_cast<HelpFormatter&>(*app_->get_formatter()).hide(&option);
}

void Command::require_one(Option& one, Option& other) {
  one.excludes(other);
  checks_.push_back([one = one.option_, other = other.option_, help = see_help(*app_)] {
    if (one->count() + other->count() == 0)
      throw BadInput("give " + one->get_name() + " or " + other->get_name() + help);
  });
}

void Command::allow_only(Option& option, std::initializer_list<std::string_view> others) {
  const std::vector<std::string_view> allowed(others);
  for (CLI::Option* other : app_->get_options([&](CLI::Option* candidate) {
         return candidate != option.option_ && candidate != app_->get_help_ptr() &&
                candidate != app_->get_help_all_ptr() &&
                std::find(allowed.begin(), allowed.end(), candidate->get_name()) == allowed.end();
       }))
    option.option_->excludes(other);
}

Option Command::add_action(const char* name, const char* type, const char* what, ReadWord read_word) {
  return add_words(name, type, what, "", false, std::move(read_word));
}

Command::ReadOption Command::read_option() const {
  return [app = app_](const std::string& name, std::string_view word) {
    CLI::Option* option = app->get_option("--" + name);
    const CLI::results_t given = option->results();  // on the command line, and read later
    option->clear();
    option->add_result(std::string(word));
    option->run_callback();
    option->clear();
    for (const std::string& one : given) option->add_result(one);
  };
}

void Command::examples(const char* text) { app_->footer(text); }

void Command::run(std::function<void()> work) {
  app_->callback([checks = checks_, work = std::move(work)] {
    for (const auto& check : checks) check();
    work();
  });
}

}  // namespace frontlux::app
