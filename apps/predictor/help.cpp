#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "command_line.h"
#include "core/text.h"

namespace predictor {
namespace {

constexpr std::size_t kMinWidth = 80, kMaxWidth = 100;  // width of a line [columns]
constexpr std::size_t kColumn = 27;                     // column at which descriptions begin

std::size_t Width() {
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return kMinWidth;
  return std::clamp<std::size_t>(size.ws_col, kMinWidth, kMaxWidth);
}

// Breaks a paragraph into lines of at most `width` columns, and indents all but the first.
std::string Wrapped(const std::string& paragraph, std::size_t indent, std::size_t width) {
  std::istringstream words(paragraph);
  std::string text, line(indent, ' ');
  for (std::string word; words >> word;) {
    if (line.size() > indent && line.size() + 1 + word.size() > width) {
      text += line + "\n";
      line.assign(indent, ' ');
    }
    line += (line.size() > indent ? " " : "") + word;
  }
  return text + line + "\n";
}

// Wraps paragraphs but leaves indented lines unchanged.
std::string WrappedText(const std::string& text, std::size_t width) {
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line);)
    out += line.empty() || line[0] == ' ' ? line + "\n" : Wrapped(line, 0, width);
  return out;
}

std::string Row(const std::string& left, const std::string& right, std::size_t width) {
  if (right.empty()) return "  " + left + "\n";
  const std::string described = Wrapped(right, kColumn, width);
  const std::string start = "  " + left;
  if (start.size() + 2 > kColumn) return start + "\n" + described;
  return start + described.substr(start.size());
}

std::string TypeOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));  // without the text that validators add
}

std::string NameOf(const CLI::Option& option) {
  if (option.nonpositional()) {
    std::string name = option.get_snames().empty() ? "    " : "-" + option.get_snames()[0] + ", ";
    name += LongNameOf(option);
    if (TypeOf(option).empty() || option.get_items_expected_max() == 0) return name;
    return name + (option.get_items_expected_min() == 0 ? " [" + TypeOf(option) + "]"
                                                        : " " + TypeOf(option));
  }
  std::string name = option.get_name();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::toupper(c); });
  return name + (option.get_items_expected_max() > 1 ? "..." : "");
}

std::string DescriptionOf(const CLI::Option& option) {
  const std::string value = option.get_default_str();
  const bool shown = !value.empty() && option.get_items_expected_min() > 0;
  return option.get_description() + (shown ? " [default: " + value + "]" : "");
}

std::vector<const CLI::Option*> OptionsOf(const CLI::App& app, bool positional) {
  std::vector<const CLI::Option*> options = app.get_options([positional](const CLI::Option* o) {
    return !o->get_group().empty() && o->nonpositional() != positional;
  });
  return options;
}

std::string UsageOf(const CLI::App& app, const std::string& name) {
  std::string usage = "Usage: " + name;
  if (!CommandsOf(app).empty()) return usage + " COMMAND [OPTIONS]";
  usage += " [OPTIONS]";
  for (const CLI::Option* option : OptionsOf(app, true))
    usage += option->get_required() ? " " + NameOf(*option) : " [" + NameOf(*option) + "]";
  return usage;
}

// The groups, in the order in which they first appear.
template <typename Item>
std::vector<std::string> GroupsOf(const std::vector<const Item*>& items) {
  std::vector<std::string> groups;
  for (const Item* item : items)
    if (std::ranges::find(groups, item->get_group()) == groups.end())
      groups.push_back(item->get_group());
  return groups;
}

// Escapes text for groff, so that groff does not treat a backslash or a leading dot as a command.
std::string Groff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
    out += c == '\\' ? "\\\\" : c == '-' ? "\\-" : std::string(1, c);
  }
  return out;
}

std::string ManCommand(const CLI::App& app) {
  std::string text = ".SS " + Groff(PathOf(app)) + "\n" + Groff(app.get_description()) + "\n.PP\n" +
                     Groff(UsageOf(app, PathOf(app))) + "\n";
  for (const bool positional : {true, false})
    for (const CLI::Option* option : OptionsOf(app, positional))
      // Options without a short form are indented.
      text += ".TP\n\\fB" + Groff(std::string(Trimmed(NameOf(*option)))) + "\\fR\n" +
              Groff(DescriptionOf(*option)) + "\n";
  if (!app.get_footer().empty()) text += ".PP\n.nf\n" + Groff(app.get_footer()) + "\n.fi\n";
  for (const CLI::App* command : CommandsOf(app)) text += ManCommand(*command);
  return text;
}

// Returns shell patterns of all commands below `app`: 'predictor run'|'predictor survey'|...
std::string Paths(const CLI::App& app) {
  std::string paths;
  for (const CLI::App* command : CommandsOf(app)) {
    const std::string below = Paths(*command);
    paths += (paths.empty() ? "'" : "|'") + PathOf(*command) + "'";
    if (!below.empty()) paths += "|" + below;
  }
  return paths;
}

void AddCompletion(const CLI::App& app, std::string* cases) {
  std::string words;
  for (const CLI::App* command : CommandsOf(app)) words += command->get_name() + " ";
  for (const CLI::Option* option : OptionsOf(app, false))
    for (const std::string& name : option->get_lnames()) words += "--" + name + " ";
  *cases += "    '" + PathOf(app) + "') words='" + words + "' ;;\n";
  for (const CLI::App* command : CommandsOf(app)) AddCompletion(*command, cases);
}

}  // namespace

std::string PathOf(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  return parent ? PathOf(*parent) + " " + app.get_name() : app.get_name();
}

std::vector<const CLI::App*> CommandsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); });
}

std::string LongNameOf(const CLI::Option& option) {
  const std::vector<std::string>& names = option.get_lnames();
  if (names.empty()) return "";
  const bool both = names.size() > 1 && names[1] == "no-" + names[0];
  return both ? "--[no-]" + names[0] : "--" + names[0];
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const {
  const std::size_t width = Width();
  std::string text =
      UsageOf(*app, PathOf(*app)) + "\n\n" + WrappedText(app->get_description(), width);
  if (const auto arguments = OptionsOf(*app, true); !arguments.empty()) {
    text += "\nArguments:\n";
    for (const CLI::Option* option : arguments)
      text += Row(NameOf(*option), DescriptionOf(*option), width);
  }
  const std::vector<const CLI::App*> commands = CommandsOf(*app);
  for (const std::string& group : GroupsOf(commands)) {
    text += "\n" + group + ":\n";
    for (const CLI::App* command : commands)
      if (command->get_group() == group)
        text += Row(command->get_name(), command->get_description(), width);
  }
  const std::vector<const CLI::Option*> options = OptionsOf(*app, false);
  for (const std::string& group : GroupsOf(options)) {
    text += "\n" + group + ":\n";
    for (const CLI::Option* option : options)
      if (option->get_group() == group) text += Row(NameOf(*option), DescriptionOf(*option), width);
  }
  if (!app->get_footer().empty()) text += "\n" + WrappedText(app->get_footer(), width);
  return text;
}

std::string ManPage(const CLI::App& app) {
  std::string text = ".TH PREDICTOR 1 \"\" \"predictor " PREDICTOR_VERSION
                     "\"\n.SH NAME\npredictor " +
                     Groff("- ") + Groff(app.get_description()) + "\n.SH SYNOPSIS\n" +
                     Groff(UsageOf(app, app.get_name())) + "\n.SH COMMANDS\n";
  for (const CLI::App* command : CommandsOf(app)) text += ManCommand(*command);
  return text + ".SH NOTES\n.nf\n" + Groff(app.get_footer()) + "\n.fi\n";
}

std::string BashCompletion(const CLI::App& app) {
  std::string cases;
  AddCompletion(app, &cases);
  return "# Completion of predictor in bash: source <(predictor completion bash)\n"
         "_predictor() {\n"
         "  local words word path=predictor\n"
         "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
         "    case \"$path $word\" in\n"
         "    " +
         Paths(app) +
         ") path+=\" $word\" ;;\n"
         "    *) break ;;\n"
         "    esac\n"
         "  done\n"
         "  case $path in\n" +
         cases +
         "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\")\n"
         "}\n"
         "complete -o default -F _predictor predictor\n";
}

}  // namespace predictor
