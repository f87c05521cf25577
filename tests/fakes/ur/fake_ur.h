// A fake controller of Universal Robots with RTDE (30004), ports for programs (30001 … 30003), and
// a dashboard (29999). This controller executes the URScript that it receives.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>

#include "fakes/far_end.h"
#include "fakes/ur/rtde_server.h"
#include "fakes/ur/ur_controller.h"

namespace predictor {

struct FakeUrOptions {
  UrVersion version;  // major version 3: a CB3 with 125 Hz; otherwise 500 Hz
  int phase = 0;      // of its cycle [ms]
  std::optional<double> payload = std::nullopt;  // as set at the pendant; empty: not reported [kg]
  std::array<double, 3> payload_cog{};           // [m]
  UrGeometry geometry = kUr5;
  UrVector tool_offset = {0.01, -0.02, 0.1, 0.3, 0.2, -0.1};  // as set at the pendant
};

class FakeUr final : public FakeDevice {
 public:
  explicit FakeUr(const FakeUrOptions& options = {});
  ~FakeUr() override;

  std::vector<std::uint16_t> tcp_ports() const override;
  void Opened(int link, std::uint16_t port) override;
  void Received(int link, std::span<const std::byte> bytes) override;
  void Closed(int link) override;
  void Step(Mechanics* mechanics) override;

  // The arm:      "protective stop", "emergency stop", "safeguard stop", "power off", "freedrive"
  //               ("freedrive off"), "unlock" (a protective stop), "not a number" (a joint angle),
  //               "slider N" [%], "press N" and "release N" (digital input N)
  // Programs:     "stop program", "pause program", "play" (a paused program), "local control"
  // The wire:     "freeze" (no more packets) and "thaw", "repeat" (the last packet permanently),
  //               "rewind" (timestamps go back by a second), "late N" [ms], "drop link",
  //               "drop dashboard" (29999), "drop primary" (30001), "mute primary" and "unmute
  //               primary", "malformed", "text", "deaf" (ignores data from clients)
  bool Do(const std::string& what) override;

  UrController& controller() { return controller_; }
  RtdeServer& rtde() { return rtde_; }
  bool running() const { return program_ != nullptr; }

 private:
  struct Late {
    long due;  // [ms]
    int link;
    Bytes bytes;
  };

  bool DoToArm(const std::string& what);
  bool DoToProgram(const std::string& what);
  bool DoToWire(const std::string& what);
  void Sample(const ArmSample& sample);
  void Cycle();
  void RunProgram();
  void Load(const std::string& text);
  void EndProgram(const std::string& why);
  void Brake(std::uint32_t safety_bits);
  void TakeProgram(int link, const std::string& text);
  std::string Dashboard(const std::string& line);
  void SayOnPrimary();
  void Drop(std::uint16_t port);
  void SendText(int link, const std::string& text);

  FakeUrOptions options_;
  UrController controller_;
  RtdeServer rtde_;
  std::unique_ptr<UrProgram> program_;
  std::map<int, std::uint16_t> ports_;     // ports of other links
  std::map<int, std::string> unfinished_;  // incomplete text from other links
  std::deque<Late> late_;
  long now_ = 0;  // [ms]
  long delay_ = 0;
  int cycle_ms_;
  bool frozen_ = false, repeats_ = false, remote_ = true, not_a_number_ = false, mute_ = false;
};

}  // namespace predictor
