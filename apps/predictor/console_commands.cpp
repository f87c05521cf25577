#include "console_commands.h"

#include <optional>

#include "screen.h"

namespace predictor {

// A command with a text must follow those whose names begin with its name and a space.
struct ConsoleCommandTable {
  using C = ConsoleCommands;
  static constexpr C::Command kRows[] = {
      {"mark", "[TEXT]", "writes a marker into the recording", &C::Mark, false},
      {"status", "", "lists the connected clients with their roles, leases and delays", &C::Status},
      {"pin look", "",
       "prints six digits with which a headset or another browser can connect within two minutes, "
       "to look on",
       &C::PinLook},
      {"pin operator", "", "the same for a client that may also take the operator's hands",
       &C::PinOperator},
      {"pin control", "", "the same for a client that may also take control", &C::PinControl},
      {"revoke control", "", "takes control away from the client that has it", &C::RevokeControl},
      {"revoke operator", "", "takes the operator's hands away from the client that has them",
       &C::RevokeOperator},
      {"kick foxglove", "", "makes all addresses issued for Foxglove invalid", &C::KickFoxglove},
      {"kick", "N", "disconnects client N; all codes and tokens issued so far become invalid",
       &C::Kick},
      {"foxglove", "", "prints an address for Foxglove, which permits viewing only", &C::Foxglove},
  };
};

namespace {

// Returns the argument if the line is this command, or nothing otherwise.
std::optional<std::string> ArgumentOf(const std::string& line,
                                      const ConsoleCommands::Command& command) {
  const std::string name = command.name, kind = command.argument;
  if (line == name) return kind == "N" ? std::nullopt : std::optional<std::string>("");
  if (kind.empty() || !line.starts_with(name + " ")) return std::nullopt;
  const std::string argument = line.substr(name.size() + 1);
  if (kind != "N") return argument;
  const bool number = argument.size() <= 9 && !argument.empty() &&
                      argument.find_first_not_of("0123456789") == std::string::npos &&
                      argument.find_first_not_of('0') != std::string::npos;
  return number ? std::optional(argument) : std::nullopt;
}

}  // namespace

std::span<const ConsoleCommands::Command> ConsoleCommands::All() {
  return ConsoleCommandTable::kRows;
}

void ConsoleCommands::Obey(const std::string& line) {
  if (line.empty()) return;
  std::string known;
  for (const Command& command : All()) {
    if (command.of_viewer && !viewer_) continue;
    if (const std::optional<std::string> argument = ArgumentOf(line, command))
      return (this->*command.run)(*argument);
    known += (known.empty() ? "" : ", ") + command.Usage();
  }
  TheScreen().Print(viewer_
                        ? "Unknown command. The commands are: " + known + ". Ctrl-C ends the run."
                        : "Unknown command. Without a viewer page, the only command is " + known +
                              ". Ctrl-C ends the run.");
}

void ConsoleCommands::Mark(const std::string& text) {
  if (recording_)
    recording_->Mark("marker: " + (text.empty() ? "console" : text));
  else
    TheScreen().Print("This run is not recorded.");
}

}  // namespace predictor
