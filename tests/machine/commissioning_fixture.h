// A rig to be commissioned. One process simulates the arms, their sensors, and the person who moves
// or presses them. The program runs at a terminal.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "machine/rig_process.h"
#include "scenario/scenario_io.h"

namespace predictor {

inline constexpr int kUnfit = 1, kBadInput = 2, kDeviceFailure = 3;  // exit codes

class Commissioning : public testing::Test {
 protected:
  explicit Commissioning(const std::array<std::string, 2>& makes = {"ur", "ur"},
                         const std::string& scenario = "dual_ur5")
      : folder_(makes), file_(FileOf(scenario)), scenario_(LoadScenario(file_)) {}

  static std::string Left(const std::string& options = "") {
    return "left=ur:" + HostOf(kLeft) + options;
  }
  static std::string Right(const std::string& options = "") {
    return "right=ur:" + HostOf(kRight) + options;
  }
  void SwitchOn(const std::vector<std::string>& fakes = {Left(), Right()}) {
    rig_.reset();
    rig_ = std::make_unique<FakeRig>(file_, fakes);
  }
  Terminal Predictor(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--machine", folder_.file()});
    return Terminal(arguments);
  }
  // Returns the file for --json, and the result that a command wrote to it.
  std::string ResultFile() const { return (folder_ / "result.json").string(); }
  nlohmann::json Result() const {
    std::ifstream in(ResultFile());
    return nlohmann::json::parse(in);
  }
  JointVector Joints(const std::string& hand) {
    std::istringstream text(rig_->Ask("joints " + hand));
    std::vector<double> q;
    for (double x = 0; text >> x;) q.push_back(x);
    return Eigen::Map<Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
  }
  static std::string Text(const JointVector& q) {
    std::ostringstream text;
    text.precision(12);
    text << q.transpose();
    return text.str();
  }
  // A person guides the arm to the joint angles `q` in free-drive and holds it at these angles.
  void Lead(const std::string& hand, const JointVector& q) {
    ASSERT_EQ(rig_->Ask("lead " + hand + " " + Text(q)), "ok");
    for (int i = 0; i < 3000 && rig_->Ask("led " + hand) != "yes"; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_EQ(rig_->Ask("led " + hand), "yes");
  }
  // Pushes the handle as the program requests. Each push lasts until the program has read it.
  void ObeyPushes(Terminal* terminal, int pushes) {
    const char* forces[] = {"12 0 0", "0 12 0", "0 0 12"};
    for (int n = 0; n < pushes; ++n) {
      // The request is "left handle along +x of the world, ...".
      const std::string reported = terminal->Line("Push the ");
      const auto at = reported.find("along +");
      ASSERT_NE(at, std::string::npos) << terminal->Screen();
      const std::string hand = reported.substr(0, reported.find(' '));
      bool read = false;
      for (int attempt = 0; attempt < 5 && !read; ++attempt) {
        // the person lets go in between
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        rig_->Ask("press " + hand + " " + forces[reported[at + 7] - 'x']);
        read = terminal->Says("  reads ", 4);
        rig_->Ask("press " + hand + " 0 0 0");
      }
      ASSERT_TRUE(read) << terminal->Screen();
    }
  }
  // Releases both handles while the program tares their sensors, and then pushes one handle.
  void PushOne(Terminal* terminal, int tares = 2) {
    for (int n = 0; n < tares; ++n) {
      ASSERT_TRUE(terminal->Says("hen press Enter.")) << terminal->Screen();
      terminal->Type("\n");
    }
    ObeyPushes(terminal, 3);
  }

  MachineFolder folder_;
  std::string file_;
  Scenario scenario_;
  std::unique_ptr<FakeRig> rig_;
};

}  // namespace predictor
