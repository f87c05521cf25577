#include "devices/franka/connection.h"

#include <cstring>

namespace predictor::fci {
namespace {

// Returns the reason why this version of the interface is unsuitable, and the remedy.
std::string VersionRefusal(std::uint16_t answered) {
  return "answers FCI version " + std::to_string(answered) +
         ", but version 10 (Franka Research 3, system 5.9 and newer) or 5 (Panda, libfranka 0.8 "
         "and 0.9) is needed: " +
         (answered > kResearch3Version
              ? "install a system version that supports it, or extend this driver."
              : "update the arm's system in Desk.");
}

// Sizes of the states [bytes].
std::string KnownSizes(std::uint16_t version) {
  return version == kPandaVersion
             ? std::to_string(sizeof(PandaState)) + " bytes"
             : std::to_string(sizeof(Research3State)) + " bytes (system 5.9 and newer) or " +
                   std::to_string(sizeof(EarlyResearch3State)) + " bytes";
}

class Connecting {
 public:
  Connecting(const FrankaOptions& options, std::uint16_t version, Network* network)
      : options_(options), address_{options.host, options.port}, network_(network) {
    c_.version = version;
    c_.datagrams = network->Open({options.host, 0}, 0);
    c_.stream = network->Connect(address_, options.timeout);
  }

  // If the robot has a different version, returns this version.
  std::optional<std::uint16_t> Greet() {
    RequestBuffer buffer;
    const Answer answer =
        Ask(EncodeConnect(c_.version, c_.next_id++, c_.datagrams->port(), &buffer));
    ConnectResponse response;
    std::memcpy(&response, answer.body.data(), sizeof response);
    // The value is copied, because the field in the packet is not aligned.
    const std::uint16_t version = response.version;
    if (response.status == 0) return std::nullopt;
    if (version == c_.version)
      throw DeviceError(address_, "refuses the connection, although it asks for FCI version " +
                                      std::to_string(c_.version) + " itself. Restart the robot.");
    return version;
  }

  Connection Finish() {
    HearFirstState();
    CheckReady();
    if (options_.collision && !options_.listen) SetCollision(*options_.collision);
    return std::move(c_);
  }

 private:
  Answer Ask(std::span<const std::byte> request) {
    Answer answer;
    bool closed = !c_.stream->Write(request);
    const bool answered = WaitUntil(network_, options_.timeout, [&] {
      if (closed) return true;
      const int n = c_.stream->Read(reader_.room());
      closed = n == Stream::kClosed || reader_.broken();
      if (n > 0) reader_.Arrived(static_cast<std::size_t>(n));
      return reader_.Next(&answer);
    });
    if (answered && !closed) return answer;
    if (closed)
      throw DeviceError(address_,
                        "closes the connection. Check that no other program controls the arm, and "
                        "that this is the port of the Franka Control Interface.");
    throw DeviceError(
        address_,
        "does not answer as the Franka Control Interface. Activate the interface in Desk.");
  }

  void HearFirstState() {
    std::array<std::byte, 4096> bytes;
    std::size_t size = 0;
    const bool heard = WaitUntil(network_, options_.timeout, [&] {
      const int n = c_.datagrams->Receive(bytes);
      if (n <= 0) return false;
      size = static_cast<std::size_t>(n);
      return !IsStateSize(c_.version, size) ||
             Decode(c_.version, std::span(bytes).first(size), &c_.state);
    });
    if (size == 0)
      throw DeviceError(address_, "answers, but sends no states to UDP port " +
                                      std::to_string(c_.datagrams->port()) +
                                      ". Check whether a firewall drops them.");
    if (!IsStateSize(c_.version, size))
      throw DeviceError(
          address_, "sends states of " + std::to_string(size) + " bytes in FCI version " +
                        std::to_string(c_.version) + "; " + KnownSizes(c_.version) +
                        " are needed. Install a supported system version, or extend this driver.");
    if (!heard) throw DeviceError(address_, "sends states with invalid numbers.");
    c_.state_size = size;
  }

  void CheckReady() const {
    const RobotState& s = c_.state;
    if (s.mode == RobotMode::kIdle && s.errors.none()) return;
    std::string why = Words(s.mode);
    if (s.mode == RobotMode::kMove) why = "is moved by another program";
    if (s.mode == RobotMode::kIdle) why = "reports an error";
    if (s.errors.any()) why += " (" + ErrorWords(s.errors) + ")";
    throw DeviceError(address_,
                      why +
                          ". Make the arm ready in Desk: open the brakes, release the user stop, "
                          "confirm errors. Check that no one is guiding the arm.");
  }

  void SetCollision(const FrankaCollision& collision) {
    RequestBuffer buffer;
    const Answer answer =
        Ask(EncodeCollision(c_.version, c_.next_id++, collision.torque, collision.force, &buffer));
    if (answer.status() != 0)
      throw DeviceError(address_, "refuses the collision thresholds (status " +
                                      std::to_string(answer.status()) +
                                      "). Check that they are within the arm's limits.");
  }

  const FrankaOptions& options_;
  Address address_;
  Network* network_;
  Connection c_;
  AnswerReader reader_;
};

}  // namespace

Connection Connect(const FrankaOptions& options, Network* network) {
  std::optional<std::uint16_t> other;
  {
    // The arm accepts one client at a time.
    Connecting first(options, options.version.value_or(kResearch3Version), network);
    other = first.Greet();
    if (!other) return first.Finish();
  }
  const std::string answers = "answers FCI version " + std::to_string(*other);
  const Address address{options.host, options.port};
  if (options.version)
    throw DeviceError(address, answers + "; version " + std::to_string(*options.version) +
                                   " was requested. Remove the version from the machine file.");
  if (*other != kPandaVersion) throw DeviceError(address, VersionRefusal(*other));
  Connecting second(options, *other, network);
  if (second.Greet())
    throw DeviceError(address, answers + ", but refuses this version. Restart the robot.");
  return second.Finish();
}

}  // namespace predictor::fci
