// The RTDE server of a fake controller, with one session for each client.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "devices/ur/rtde.h"
#include "fakes/far_end.h"
#include "fakes/ur/ur_controller.h"

namespace predictor {

struct UrVersion {
  std::uint32_t major = 5, minor = 12, bugfix = 0, build = 1101319;
  bool AtLeast(std::uint32_t a, std::uint32_t b) const {
    return major > a || (major == a && minor >= b);
  }
};

class RtdeServer {
 public:
  using SendBytes = std::function<void(int link, std::span<const std::byte>)>;
  using LogLine = std::function<void(const std::string&)>;

  RtdeServer(UrController* controller, const UrVersion& version, SendBytes send, LogLine log)
      : controller_(controller), version_(version), send_(std::move(send)), log_(std::move(log)) {}

  void Opened(int link) { sessions_[link] = std::make_unique<Session>(); }
  void Closed(int link) { sessions_.erase(link); }
  void Received(int link, std::span<const std::byte> bytes);
  bool Has(int link) const { return sessions_.count(link) != 0; }
  std::vector<int> links() const;

  // Performs one cycle, in which it sends the requested outputs to each client.
  void Cycle();
  // Sends the last packet again.
  void Repeat();

  std::uint16_t newest_protocol = 2;
  std::set<std::string> in_use;  // names that a fieldbus adapter has claimed
  std::set<std::string> unknown;
  bool deaf = false;  // received data is discarded

 private:
  struct Session {
    rtde::PacketParser parser;
    std::vector<std::string> outputs;
    int divisor = 1;  // number of cycles between packets
    bool started = false;
    std::map<int, std::vector<std::string>> inputs;  // by recipe number
    Bytes last;
  };

  void Answer(int link, Session* session, const rtde::Packet& packet);
  void SetUp(int link, Session* session, const rtde::Packet& packet);
  void TakeData(Session* session, std::span<const std::byte> payload);
  std::string TypeOf(const std::string& name, bool input, const Session* session) const;
  int registers() const;  // of each kind
  bool Claimed(const std::string& name, const Session* except) const;
  void Put(const std::string& name, rtde::PacketWriter* writer) const;
  void Send(int link, rtde::PacketWriter* writer) { send_(link, writer->Finish()); }

  UrController* controller_;
  UrVersion version_;
  SendBytes send_;
  LogLine log_;
  std::map<int, std::unique_ptr<Session>> sessions_;
  long cycle_ = 0;
};

}  // namespace predictor
