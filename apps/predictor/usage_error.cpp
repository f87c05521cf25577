#include <algorithm>
#include <array>
#include <regex>
#include <utility>

#include "command_line.h"
#include "core/text.h"

namespace predictor {
namespace {

// Returns the innermost command on the command line.
const CLI::App* Innermost(const CLI::App* app) {
  const auto parsed = app->get_subcommands();
  return parsed.empty() ? app : Innermost(parsed.back());
}

std::vector<std::string> OptionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string Text(const std::string& error, const std::string& hint) {
  return "predictor: error: " + error + "\nhint: " + hint;
}

// Returns the parser's message in this program's wording. The message names arguments as the help
// does, for example SCENARIO.
std::string Rephrased(std::string message) {
  static const std::array<std::pair<std::regex, const char*>, 7> kSentences = {{
      {std::regex("(.*) is required"), "$1 is missing."},
      {std::regex("Could not convert: (.*) = (.*)"), "\"$2\" is not a valid value of $1."},
      {std::regex("(.*): \\d+ required .* missing"), "$1 needs a value."},
      // Without the zeros at the end of 2.500000.
      {std::regex("(.*): Value (.*) not in range (-?\\d+(?:\\.\\d*[1-9])?)\\.?0* to "
                  "(-?\\d+(?:\\.\\d*[1-9])?)\\.?0*"),
       "$1 must be $3 to $4, not $2."},
      {std::regex("(.*): Value (.*) not in range (.*) to (.*)"), "$1 must be $3 to $4, not $2."},
      {std::regex("(.*): (.*) not in \\{(.*)\\}"), "$1 must be one of $3, not $2."},
      {std::regex("(.*) requires (.*)"), "$1 requires $2."},
  }};
  constexpr std::size_t kMaxLength = 500;  // maximum length of text for the expressions
  if (message.size() > kMaxLength) return message;
  for (const auto& [pattern, sentence] : kSentences) {
    if (!std::regex_match(message, pattern)) continue;
    message =
        std::regex_replace(message, pattern, sentence, std::regex_constants::format_first_only);
    break;
  }
  const std::size_t end = std::min(message.find_first_of(" :"), message.size());
  if (message[0] >= 'a' && message[0] <= 'z')
    std::transform(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(end),
                   message.begin(), [](unsigned char c) { return std::toupper(c); });
  return message.ends_with('.') ? message : message + ".";
}

}  // namespace

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : CommandsOf(app)) names.push_back(command->get_name());
  return names;
}

std::string UnknownCommand(const CLI::App& app, const std::string& word) {
  const std::vector<std::string> commands = CommandNames(app);
  const std::string nearest = Nearest(word, commands);
  const std::string path = PathOf(app) + " " + word;
  return Text("there is no command " + Quote(path.substr(path.find(' ') + 1)) + ".",
              nearest.empty() ? "The commands are " + Join(commands) + "."
                              : "Did you mean `" + PathOf(app) + " " + nearest + "`?");
}

std::string UsageError(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = *Innermost(&app);
  const std::string help = "`" + PathOf(command) + " --help` shows how to use it.";
  const std::vector<std::string> unknown = app.remaining(true);
  const std::vector<std::string> commands = CommandNames(command);
  const auto option = std::ranges::find_if(
      unknown, [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
  if (!commands.empty()) {
    const auto word = std::ranges::find_if(
        unknown, [](const std::string& it) { return it.empty() || it[0] != '-'; });
    if (word < option) return UnknownCommand(command, *word);
    if (word != unknown.end())
      return Text("there is no option " + Quote(*option) + " before the command.",
                  "Give the command first. " + help);
    if (option == unknown.end())
      return Text("a command is missing.", "The commands are " + Join(commands) + ".");
  }
  if (option != unknown.end()) {
    const std::string name = option->substr(0, option->find('='));
    const std::string nearest = Nearest(name, OptionNames(command));
    if (nearest == name)
      return Text("there is no option " + Quote(name) + " before the command.",
                  "Write " + name + " after `" + PathOf(command) + "`.");
    return Text("there is no option " + Quote(name) + ".",
                nearest.empty() ? help : "Did you mean " + nearest + "?");
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !unknown.empty())
    return Text("unexpected argument " + Quote(unknown.front()) + ".", help);
  return Text(Rephrased(error.what()), help);
}

}  // namespace predictor
