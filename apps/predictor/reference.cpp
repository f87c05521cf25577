// The reference of the console, for the documentation.
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console_commands.h"
#include "safety/console_keys.h"

namespace predictor {

std::string ConsoleReference() {
  auto commands = nlohmann::ordered_json::array(), keys = nlohmann::ordered_json::array();
  for (const ConsoleCommands::Command& command : ConsoleCommands::All())
    commands.push_back({{"command", command.Usage()},
                        {"of_viewer", command.of_viewer},
                        {"meaning", command.meaning}});
  for (const ConsoleKey& key : kConsoleKeys)
    keys.push_back(
        {{"key", std::string(1, key.key)}, {"held", key.held}, {"meaning", key.meaning}});
  keys.push_back({{"key", std::string(1, kCommandKey)},
                  {"held", false},
                  {"meaning", "begins a command; Enter executes the command"}});
  return nlohmann::ordered_json{{"commands", commands}, {"keys", keys}}.dump(2) + "\n";
}

}  // namespace predictor
