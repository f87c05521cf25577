// The device side of the wire for tests. It consists of fakes that use a real protocol, byte by
// byte, in steps of a millisecond. The fakes depend on no socket and no clock. The same code
// therefore runs in memory and virtual time (memory_network.h), and over sockets in a separate
// process (fake_rig.cpp).
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

// The sending side of a fake. `link` is the number of a TCP connection that a client has opened.
class Wire {
 public:
  virtual ~Wire() = default;
  virtual void Send(int link, std::span<const std::byte> bytes) = 0;
  virtual void Close(int link) = 0;
  // Sends UDP from the fake's port to a port of the client. The client is the last computer that
  // has sent data.
  virtual void SendDatagram(std::uint16_t from, std::uint16_t to,
                            std::span<const std::byte> bytes) = 0;
};

// Connects a fake with an arm of a rig and its sensor. The caller steps the rig. Before the caller
// calls the fake's Step, it must fill in the sample. After that, it must pass the resulting command
// to the arm.
struct Mechanics {
  ArmSample sample;     // current joints and sensor reading
  JointVector command;  // joint velocities that the controller commands [rad/s]
};

class FakeDevice {
 public:
  virtual ~FakeDevice() = default;

  virtual std::vector<std::uint16_t> tcp_ports() const { return {}; }
  virtual std::vector<std::uint16_t> udp_ports() const { return {}; }
  virtual void Opened(int /*link*/, std::uint16_t /*port*/) {}
  // Receives a piece of a stream, which may be cut anywhere.
  virtual void Received(int /*link*/, std::span<const std::byte> /*bytes*/) {}
  virtual void Closed(int /*link*/) {}
  virtual void ReceivedDatagram(std::uint16_t /*port*/, std::uint16_t /*from*/,
                                std::span<const std::byte> /*bytes*/) {}
  // Lets one millisecond pass.
  virtual void Step(Mechanics* mechanics) = 0;
  // Causes an event outside the protocol ("protective stop", "emergency stop", ...). Words with
  // parameters describe the event. Returns false if the event is unknown.
  virtual bool Do(const std::string& /*what*/) { return false; }
  // Returns the events that a test may read, one per line, such as lost commands or refused words.
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
