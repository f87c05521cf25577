// The Foxglove WebSocket protocol, read-only: channels in JSON that Foxglove and its forks show as
// 3D scene, plots and state. What a client did not subscribe to is not sent, nor even written.
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

namespace predictor {

class Foxglove {
 public:
  static constexpr std::size_t kMostClients = 16;
  static constexpr std::size_t kMostSubscriptions = 64;  // of one client
  static constexpr std::size_t kLongestMessage = 16 * 1024;
  static constexpr std::uint64_t kPeriod = 20'000'000;  // between messages of a channel [ns]

  Foxglove(const Scenario& scenario, const Vector3& object_start, MonotonicClock clock);
  ~Foxglove();

  // The subprotocol to answer with; empty if none of those offered is known.
  static std::string Choose(const std::vector<std::string>& offered);

  // token: by which it was admitted.
  std::unique_ptr<Session> Open(Connection* connection, std::string token);
  // The newest state, to those who subscribed; what comes too soon is left out.
  void Publish(const TickRecord& record);
  std::size_t clients() const { return clients_.size(); }
  // Throws everybody out. Returns by which tokens they had come.
  std::vector<std::string> Kick();
  // The run has ended for good: a sentence to everybody, who is let go.
  void EndRun(const std::string& text);

 private:
  class Client;
  std::vector<FoxgloveChannel> channels_;  // channel ids count from 1
  MonotonicClock clock_;
  std::uint64_t to_unix_ns_;  // from the monotonic clock
  std::uint64_t last_ns_ = 0;
  std::vector<Client*> clients_;
};

}  // namespace predictor
