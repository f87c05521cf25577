// The Foxglove WebSocket protocol, read-only. Foxglove and its forks show the JSON channels as a 3D
// scene, plots and state. Channels without subscribers are neither sent nor encoded.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/record.h"
#include "foxglove/channels.h"
#include "scenario/scenario.h"
#include "viewer/connection.h"
#include "viewer/hub.h"

namespace predictor::viewer {

class Foxglove {
 public:
  static constexpr std::size_t kMaxClients = 16;
  static constexpr std::size_t kMaxSubscriptions = 64;  // maximum number per client
  static constexpr std::size_t kLongestMessage = 16 * 1024;
  // Minimum time between messages of a channel [ns]
  static constexpr std::uint64_t kPeriod = 20'000'000;

  Foxglove(const Scenario& scenario, const Vector3& object_start, MonotonicClock clock);
  ~Foxglove();

  // Returns the subprotocol with which the server answers, or "" if it supports none of the offered
  // ones.
  static std::string Choose(const std::vector<std::string>& offered);

  std::unique_ptr<Session> Open(Connection* connection);
  // Sends the newest state to its subscribers, and skips states that follow too soon.
  void Publish(const TickRecord& record);
  std::size_t clients() const { return clients_.size(); }
  // Disconnects all clients and returns their number.
  std::size_t Kick();
  // Sends `text` to all clients and disconnects them when the run has ended.
  void EndRun(const std::string& text);

 private:
  class Client;
  std::vector<FoxgloveChannel> channels_;  // channel IDs start at 1
  MonotonicClock clock_;
  std::uint64_t to_unix_ns_;  // offset from the monotonic clock
  std::uint64_t last_ns_ = 0;
  std::vector<Client*> clients_;
};

}  // namespace predictor::viewer
