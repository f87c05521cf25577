// The pages that are connected: who was admitted, who holds which lease, what they may put into the
// run, and what they all get to see. No sockets; the clock is handed in.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "core/status.h"
#include "scenario/live_parameters.h"
#include "viewer/connection.h"
#include "viewer/protocol.h"

namespace predictor {

using MonotonicClock = std::function<std::uint64_t()>;  // [ns]

struct HubSetup {
  Json scene;
  bool simulated = true;          // else align, start and reset are given at the console alone
  bool browser_operator = false;  // pages may lend a hand
  std::array<bool, kHands> present = {true, true};
  std::array<ParameterRange, kParameters> ranges;
  std::vector<std::string> scenarios;  // names of those that may be chosen
  bool replay = false;                 // this is a recording: nothing but its playing is commanded
};

// What the console may know of a client.
struct ClientStatus {
  std::uint32_t id = 0;
  Role role = Role::kLook;
  std::array<bool, kLeases> holds = {};
  bool headset = false;
  LatencyRequest latency;  // what it says of its delays
};

class Hub {
 public:
  static constexpr std::size_t kMostClients = 64;
  static constexpr std::size_t kMostOfOneToken = 8;
  static constexpr std::size_t kKeptSeats = 8;             // for roles that may do more than look
  static constexpr std::uint64_t kSilent = 1'500'000'000;  // heartbeats come every second [ns]
  static constexpr std::uint64_t kHelloTime = 5'000'000'000;        // [ns]
  static constexpr std::uint64_t kImmersiveLinger = 1'000'000'000;  // after the page has gone [ns]

  // Both are borrowed.
  Hub(HubSetup setup, Admission* admission, RunMailbox* mailbox, MonotonicClock clock);
  ~Hub();

  std::unique_ptr<Session> Open(Connection* connection);

  // The newest state, to everybody.
  void Publish(std::shared_ptr<const std::string> frame, RunState state);
  // What time does: leases and patience run out. At least ten times a second.
  void Tick();
  // At the console.
  void Revoke(LeaseKind kind);
  // Throws a client out, and whoever shows the same token or one that nobody uses at present.
  // Returns what later processes are to be told of it (Admission::Revoke); nothing if there is no
  // such client.
  std::optional<std::string> Kick(std::uint32_t client);
  // After any Admission::Revoke: those who are in get new tokens.
  void RenewTokens();
  // A sentence to everybody.
  void Notify(const std::string& text);
  // The run has ended for good: everybody, and whoever still comes, gets the newest state and a
  // sentence of how it ended, and is let go.
  void EndRun(const std::string& text);

  std::size_t clients() const;  // admitted
  std::vector<ClientStatus> Status() const;

 private:
  class Client;
  struct Headset {
    std::uint32_t client = 0;
    std::uint64_t frame_ns = 0;  // last sign of life: of the page and of its picture, the older
    std::uint64_t gone_ns = 0;   // since when page or session have ended; 0: they have not
  };

  const char* NoSeatFor(const Admission::Grant& grant) const;
  void Tell(const std::string& text);
  bool ended() const { return !how_ended_.empty(); }
  void TellLeases();
  void ExpireLeases();
  void See(std::uint32_t client, const ImmersiveRequest& request);
  void ShowHead(std::uint32_t client, const ImmersiveRequest& request);
  void TellHeadsets();

  HubSetup setup_;
  Admission* admission_;
  RunMailbox* mailbox_;
  MonotonicClock clock_;
  std::string server_id_;
  Leases leases_;
  std::vector<Client*> sessions_;  // admitted or not
  std::vector<Headset> headsets_;
  std::uint32_t last_client_ = 0;
  std::shared_ptr<const std::string> frame_;
  RunState state_ = RunState::kInit;
  std::string how_ended_;  // a sentence; empty: the run has not
};

}  // namespace predictor
