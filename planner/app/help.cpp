#include "help.hpp"

#include "bad_input.hpp"

#include <frontlux/file.hpp>
#include <frontlux/sim/built_in_worlds.hpp>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

namespace frontlux::app {
namespace {

using Commands = std::vector<const CLI::App*>;

Commands commands_of(const CLI::App& app) { return app.get_subcommands({}); }

// ---- man pages

// Text as roff takes it: no line is a request, and dashes stay dashes.
std::string roff(std::string_view text) {
  std::string out;
  bool at_begin = true;
  for (const char c : text) {
    if (at_begin && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    at_begin = c == '\n';
  }
  return out;
}

std::string heading(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return ".SH " + text + "\n";
}

std::string option_entry(const HelpFormatter& formatter, const CLI::Option& option) {
  std::string names;
  for (const auto& [dashes, list] : {std::pair{"-", &option.get_snames()}, {"--", &option.get_lnames()}})
    for (const std::string& name : *list)
      names.append(names.empty() ? "" : ", ").append("\\fB").append(roff(dashes + name)).append("\\fR");
  if (names.empty()) names = "\\fI" + roff(option.get_name(true)) + "\\fR";
  std::string type = option.get_positional() ? "" : formatter.make_option_opts(&option);
  if (!type.empty()) type = " \\fI" + roff(type.substr(1)) + "\\fR";
  return ".TP\n" + names + type + "\n" + roff(formatter.make_option_desc(&option)) + "\n";
}

std::string man_page(const CLI::App& app, const std::string& name, const CLI::App* root) {
  const auto& formatter = dynamic_cast<const HelpFormatter&>(*app.get_formatter());
  const std::string command = root == nullptr ? name : "frontlux " + app.get_name();
  std::string summary = app.get_description();
  summary[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(summary[0])));
  std::string page = ".TH " + roff(name) + " 1 \"\" \"frontlux " FRONTLUX_VERSION "\" \"User Commands\"\n" +
                     heading("name") + roff(name) + " \\- " + roff(summary) + "\n" + heading("synopsis") +
                     "\\fB" + roff(command) + "\\fR [\\fIOPTIONS\\fR]";
  std::string arguments;
  for (const CLI::Option* option :
       app.get_options([](const CLI::Option* o) { return o->get_positional(); })) {
    page += " \\fI" + roff(formatter.make_option_usage(option)) + "\\fR";
    arguments += option_entry(formatter, *option);
  }
  page += root == nullptr ? " \\fICOMMAND\\fR ...\n" : "\n";
  if (!arguments.empty()) page += heading("arguments") + arguments;
  page += heading("options");
  for (const std::string& group : app.get_groups()) {
    const auto options = app.get_options(
        [&](const CLI::Option* o) { return o->get_group() == group && !o->get_positional(); });
    if (group.empty() || options.empty()) continue;
    if (group != "Options") page += ".SS " + roff(group) + "\n";
    for (const CLI::Option* option : options) page += option_entry(formatter, *option);
  }
  std::string also;
  for (const CLI::App* other : commands_of(root == nullptr ? app : *root)) {
    if (root == nullptr && also.empty()) page += heading("commands");
    if (root == nullptr)
      page += ".TP\n\\fB" + roff(other->get_name()) + "\\fR\n" + roff(other->get_description()) + "\n";
    if (other != &app) also += ",\n.BR frontlux\\-" + roff(other->get_name()) + " (1)";
  }
  also = root == nullptr ? also.substr(2) : ".BR frontlux (1)" + also;
  page += heading("notes") + ".nf\n" + roff(app.get_footer()) + "\n.fi\n" + heading("see also") + also + "\n";
  return page;
}

// ---- completion

// What bash proposes for the value of an option; empty: nothing.
std::string proposal(const std::string& type) {
  if (is_folder(type)) return "_frontlux_files -d";
  if (is_file(type)) return "_frontlux_files -f";
  if (type.find('|') == std::string::npos || type.find('[') != std::string::npos) return {};
  std::string words;
  for (std::size_t begin = 0, end = 0; end < type.size(); begin = end + 1) {
    end = std::min(type.find('|', begin), type.size());
    // A word in capitals stands for a value.
    if (std::islower(static_cast<unsigned char>(type[begin])) == 0) continue;
    words.append(words.empty() ? "" : " ").append(type, begin, end - begin);
  }
  return "_frontlux_words '" + words + "'";
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line.append(line.empty() ? "" : " ").append(word);
  return line;
}

std::string completion(const CLI::App& app) {
  std::vector<std::string> commands{"help"}, worlds;
  for (const auto& world : sim::built_in_worlds()) worlds.emplace_back(world.name);
  std::string values, options;
  for (const CLI::App* command : commands_of(app)) {
    commands.push_back(command->get_name());
    std::string places;
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_positional()) {
        places = option->get_name(true) == "WORLD" ? "_frontlux_words '" + joined(worlds) + "'; " : "";
        continue;
      }
      std::string names;
      for (const auto& [dashes, list] :
           {std::pair{"-", &option->get_snames()}, {"--", &option->get_lnames()}})
        for (const std::string& name : *list)
          names.append(names.empty() ? "" : "|").append(command->get_name() + ":" + dashes + name);
      if (const std::string words = proposal(option->get_type_name()); !words.empty())
        values += "    " + names + ") " + words + "; return ;;\n";
      else if (option->get_type_size() != 0 && !option->get_type_name().empty())
        values += "    " + names + ") return ;;\n";
    }
    options += "    " + command->get_name() + ":-*) _frontlux_words '" +
               joined(option_names(*command, true)) + "' ;;\n";
    options += "    " + command->get_name() + ":*) " + places + "_frontlux_files -f ;;\n";
  }
  return R"(# bash completion for frontlux, written by frontlux --manual
_frontlux_words() { COMPREPLY+=($(compgen -W "$1" -- "$word")); }
_frontlux_files() {
  compopt -o filenames 2>/dev/null
  local IFS=$'\n'
  COMPREPLY+=($(compgen "$1" -- "$word"))
}
_frontlux() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${COMP_WORDS[i]} != -* ]]; then
      command=${COMP_WORDS[i]}
      break
    fi
  done
  case $command:$before in
)" + values +
         R"(    help:help) _frontlux_words ')" + joined({commands.begin() + 1, commands.end()}) +
         R"('; return ;;
  esac
  case $command:$word in
)" + options +
         R"(    :-*) _frontlux_words ')" + joined(option_names(app, true)) + R"(' ;;
    :*) _frontlux_words ')" +
         joined(commands) + R"(' ;;
  esac
}
complete -F _frontlux frontlux
)";
}

}  // namespace

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (option->get_type_size() == 0 || option->get_type_name().empty()) return "";
  return " " + option->get_type_name();
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  if (option->get_required()) return option->get_description() + " (required)";
  const std::string value = option->get_default_str();
  return option->get_description() + (value.empty() ? "" : " [" + value + "]");
}

// An argument in the usage: "MAP", "[WORLD]", "RUN...".
std::string HelpFormatter::make_option_usage(const CLI::Option* option) const {
  const std::string name = option->get_name(true) + (option->get_expected_max() > 1 ? "..." : "");
  return option->get_required() ? name : "[" + name + "]";
}

std::string HelpFormatter::make_group(std::string group, bool positional,
                                      std::vector<const CLI::Option*> options) const {
  if (!all_) std::erase_if(options, [this](const CLI::Option* option) { return rare_.contains(option); });
  return options.empty() ? "" : CLI::Formatter::make_group(std::move(group), positional, std::move(options));
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  all_ = mode != CLI::AppFormatMode::Normal;
  std::string help = CLI::Formatter::make_help(app, std::move(name), mode);
  for (std::size_t gap; (gap = help.find("\n\n\n")) != std::string::npos;) help.erase(gap, 1);
  return help;
}

bool is_file(std::string_view type) { return type.starts_with("FILE"); }
bool is_folder(std::string_view type) { return type == "DIR"; }

void check_name(const std::string& option, std::string_view word, std::string_view type) {
  if (word.empty() && is_file(type)) throw BadInput(option + ": '' names no file; name one");
  if (word.empty() && is_folder(type)) throw BadInput(option + ": '' names no folder; name one");
}

std::vector<std::string> option_names(const CLI::App& app, bool with_short) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    if (with_short)
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

void write_manual(const CLI::App& app, const std::filesystem::path& folder) {
  try {
    const std::filesystem::path pages = folder / "man1", completions = folder / "completions";
    std::filesystem::create_directories(pages);
    std::filesystem::create_directories(completions);
    write_file(pages / "frontlux.1", man_page(app, "frontlux", nullptr));
    for (const CLI::App* command : commands_of(app)) {
      const std::string name = "frontlux-" + command->get_name();
      write_file(pages / (name + ".1"), man_page(*command, name, &app));
    }
    write_file(completions / "frontlux", completion(app));
  } catch (const std::filesystem::filesystem_error& error) {
    throw BadInput("--manual: " + folder.string() + " cannot be written: " + error.code().message());
  } catch (const std::runtime_error& error) {
    throw BadInput(std::string("--manual: ") + error.what());
  }
}

}  // namespace frontlux::app
