// The far end of the wire for tests: devices that speak a real protocol, bytes in and bytes out, a
// millisecond at a time. They know no socket and no clock, so the same code answers in memory by
// virtual time (memory_network.h) and over sockets in a process of its own (fake_rig.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/messages.h"

namespace predictor {

using Bytes = std::vector<std::byte>;

// What a fake sends by. `link` numbers a TCP connection that a client has opened to it.
class Wire {
 public:
  virtual ~Wire() = default;
  virtual void Send(int link, std::span<const std::byte> bytes) = 0;
  virtual void Close(int link) = 0;
  // UDP from the fake's port to the client's; the client is the machine that was heard last.
  virtual void SendDatagram(std::uint16_t from, std::uint16_t to,
                            std::span<const std::byte> bytes) = 0;
};

// What hangs on a fake: the arm of a rig, with its sensor. Whoever steps the rig fills the sample
// in before a fake's Step, and gives the arm what Step left as command.
struct Mechanics {
  ArmSample sample;     // as the arm's joints and its sensor are now
  JointVector command;  // joint velocities that the controller's own motion asks for now [rad/s]
};

class FakeDevice {
 public:
  virtual ~FakeDevice() = default;

  virtual std::vector<std::uint16_t> tcp_ports() const { return {}; }
  virtual std::vector<std::uint16_t> udp_ports() const { return {}; }
  virtual void Opened(int /*link*/, std::uint16_t /*port*/) {}
  // A piece of a stream, cut anywhere.
  virtual void Received(int /*link*/, std::span<const std::byte> /*bytes*/) {}
  virtual void Closed(int /*link*/) {}
  virtual void ReceivedDatagram(std::uint16_t /*port*/, std::uint16_t /*from*/,
                                std::span<const std::byte> /*bytes*/) {}
  // One millisecond passes.
  virtual void Step(Mechanics* mechanics) = 0;
  // What a test asks of it beside the protocol ("protective stop", "emergency stop", ...): a word
  // and what it needs. False: not known.
  virtual bool Do(const std::string& /*what*/) { return false; }
  // What it has seen, a line an event, for a test to read: lost commands, refused words, ....
  const std::vector<std::string>& log() const { return log_; }

  void Attach(Wire* wire) { wire_ = wire; }

 protected:
  Wire& wire() { return *wire_; }
  void Log(const std::string& line) { log_.push_back(line); }

 private:
  Wire* wire_ = nullptr;
  std::vector<std::string> log_;
};

}  // namespace predictor
