// The commands that a person may type at the console during a run.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "recorded_run.h"
#include "viewer/viewer_process.h"

namespace predictor {

class ConsoleCommands {
 public:
  struct Command {
    const char* name;
    const char* argument;  // "", "N" for a number above 0, or "[TEXT]"
    const char* meaning;
    // `argument` is the text after the name, for "N" only digits.
    void (ConsoleCommands::*run)(const std::string& argument);
    bool of_viewer = true;  // exists only if the run has a viewer
    std::string Usage() const { return name + std::string(*argument ? " " : "") + argument; }
  };
  static std::span<const Command> All();

  // Either argument may be null.
  ConsoleCommands(viewer::ViewerProcess* viewer, RunRecording* recording)
      : viewer_(viewer), recording_(recording) {}

  // Executes a typed line. Prints the list of commands if there is no such command.
  void Obey(const std::string& line);

 private:
  friend struct ConsoleCommandTable;
  void Mark(const std::string& text);
  void Status(const std::string&) { viewer_->AskStatus(); }
  void PinLook(const std::string&) { viewer_->AskPin("look"); }
  void PinOperator(const std::string&) { viewer_->AskPin("operator"); }
  void PinControl(const std::string&) { viewer_->AskPin("control"); }
  void RevokeControl(const std::string&) { viewer_->Revoke("control"); }
  void RevokeOperator(const std::string&) { viewer_->Revoke("operator"); }
  void Foxglove(const std::string&) { viewer_->AskFoxglove(); }
  void KickFoxglove(const std::string&) { viewer_->KickFoxglove(); }
  void Kick(const std::string& client) {
    viewer_->Kick(static_cast<std::uint32_t>(std::stoul(client)));
  }

  viewer::ViewerProcess* viewer_;
  RunRecording* recording_;
};

}  // namespace predictor
