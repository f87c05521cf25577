#include "fakes/ur/rtde_server.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace predictor {
namespace {

using rtde::PacketType;
using rtde::PacketWriter;

std::vector<std::string> Split(std::span<const std::byte> bytes) {
  std::istringstream text(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  std::vector<std::string> parts;
  for (std::string part; std::getline(text, part, ',');) parts.push_back(part);
  return parts;
}

// Returns the number at the end of "input_int_register_12", or −1 for any other name.
int RegisterOf(const std::string& name, const std::string& kind) {
  const std::string head = kind + "_register_";
  if (name.compare(0, head.size(), head) != 0) return -1;
  const std::string digits = name.substr(head.size());
  if (digits.empty() || digits.size() > 2 ||
      digits.find_first_not_of("0123456789") != std::string::npos)
    return -1;
  const int number = std::stoi(digits);
  return number < static_cast<int>(UrController::kRegisters) ? number : -1;
}

void PutAll(const UrVector& values, PacketWriter* writer) {
  for (const double x : values) writer->Put(x);
}

const std::map<std::string, std::string>& Outputs() {
  static const std::map<std::string, std::string> kOutputs = {
      {"timestamp", "DOUBLE"},
      {"actual_q", "VECTOR6D"},
      {"actual_qd", "VECTOR6D"},
      {"target_qd", "VECTOR6D"},
      {"robot_mode", "INT32"},
      {"robot_status_bits", "UINT32"},
      {"safety_status_bits", "UINT32"},
      {"runtime_state", "UINT32"},
      {"ft_raw_wrench", "VECTOR6D"},
      {"target_speed_fraction", "DOUBLE"},
      {"payload", "DOUBLE"},
      {"payload_cog", "VECTOR3D"},
      {"actual_TCP_pose", "VECTOR6D"},
      {"tcp_offset", "VECTOR6D"},
      {"actual_digital_input_bits", "UINT64"}};
  return kOutputs;
}

}  // namespace

std::vector<int> RtdeServer::links() const {
  std::vector<int> links;
  for (const auto& [link, session] : sessions_) links.push_back(link);
  return links;
}

// The RTDE guide defines these numbers.
int RtdeServer::registers() const {
  const bool cb3 = version_.major == 3;
  if (cb3 && version_.minor < 4) return 0;
  return version_.AtLeast(5, 3) || (cb3 && version_.minor >= 9) ? 48 : 24;
}

void RtdeServer::Received(int link, std::span<const std::byte> bytes) {
  Session* session = sessions_.at(link).get();
  while (!bytes.empty()) {
    const auto room = session->parser.Room();
    const std::size_t n = std::min(room.size(), bytes.size());
    std::copy_n(bytes.begin(), n, room.begin());
    session->parser.Filled(n);
    bytes = bytes.subspan(n);
    rtde::Packet packet;
    while (session->parser.Next(&packet)) Answer(link, session, packet);
    if (session->parser.broken()) {
      log_("malformed packet");
      return;
    }
  }
}

void RtdeServer::Answer(int link, Session* session, const rtde::Packet& packet) {
  PacketWriter writer(packet.type);
  switch (packet.type) {
    case PacketType::kVersion: {
      BigEndianReader reader(packet.payload);
      const auto asked = reader.Get<std::uint16_t>();
      writer.Put(static_cast<std::uint8_t>(reader.ok() && asked <= newest_protocol));
      return Send(link, &writer);
    }
    case PacketType::kControllerVersion:
      writer.Put(version_.major).Put(version_.minor).Put(version_.bugfix).Put(version_.build);
      return Send(link, &writer);
    case PacketType::kOutputs:
    case PacketType::kInputs:
      return SetUp(link, session, packet);
    case PacketType::kStart:
    case PacketType::kPause:
      session->started = packet.type == PacketType::kStart;
      writer.Put(std::uint8_t{1});
      return Send(link, &writer);
    case PacketType::kData:
      return TakeData(session, packet.payload);
    case PacketType::kText:
      return log_("text");
  }
}

bool RtdeServer::Claimed(const std::string& name, const Session* except) const {
  if (in_use.count(name) != 0) return true;
  for (const auto& [link, session] : sessions_) {
    if (session.get() == except) continue;
    for (const auto& [id, names] : session->inputs)
      if (std::find(names.begin(), names.end(), name) != names.end()) return true;
  }
  return false;
}

std::string RtdeServer::TypeOf(const std::string& name, bool input, const Session* session) const {
  const std::string side = input ? "input" : "output";
  if (unknown.count(name) != 0) return "NOT_FOUND";
  if (input && Claimed(name, session)) return "IN_USE";
  const int integer = RegisterOf(name, side + "_int"), real = RegisterOf(name, side + "_double");
  if (std::max(integer, real) >= registers()) return "NOT_FOUND";
  if (integer >= 0) return "INT32";
  if (real >= 0) return "DOUBLE";
  const auto it = Outputs().find(name);
  if (input || it == Outputs().end()) return "NOT_FOUND";
  if (name == "ft_raw_wrench" && !version_.AtLeast(5, 9)) return "NOT_FOUND";
  if (name.starts_with("payload") && !controller_->payload) return "NOT_FOUND";
  return it->second;
}

void RtdeServer::SetUp(int link, Session* session, const rtde::Packet& packet) {
  const bool input = packet.type == PacketType::kInputs;
  BigEndianReader reader(packet.payload);
  const double rate = input ? 0 : reader.Get<double>();
  const auto names = Split(reader.rest());
  std::string types;
  bool good = true;
  for (const std::string& name : names) {
    const std::string type = TypeOf(name, input, session);
    good = good && type != "NOT_FOUND" && type != "IN_USE";
    types += (types.empty() ? "" : ",") + type;
  }
  int id = 0;
  if (good && input) {
    id = static_cast<int>(session->inputs.size()) + 1;
    session->inputs[id] = names;
  } else if (good) {
    id = 1;
    session->outputs = names;
    session->divisor = std::max(1, static_cast<int>(std::lround(1 / (rate * controller_->cycle))));
  }
  PacketWriter writer(packet.type);
  writer.Put(static_cast<std::uint8_t>(id)).Put(types);
  Send(link, &writer);
}

void RtdeServer::TakeData(Session* session, std::span<const std::byte> payload) {
  BigEndianReader reader(payload);
  const auto it = session->inputs.find(reader.Get<std::uint8_t>());
  if (it == session->inputs.end()) return log_("data of an unknown recipe");
  UrController next = *controller_;
  for (const std::string& name : it->second) {
    if (const int i = RegisterOf(name, "input_int"); i >= 0)
      reader.Get(&next.input_int[static_cast<std::size_t>(i)]);
    if (const int i = RegisterOf(name, "input_double"); i >= 0)
      reader.Get(&next.input_double[static_cast<std::size_t>(i)]);
  }
  if (!reader.exactly()) return log_("data of the wrong size");
  if (!deaf) *controller_ = next;
}

void RtdeServer::Put(const std::string& name, PacketWriter* writer) const {
  const UrController& c = *controller_;
  if (const int i = RegisterOf(name, "output_int"); i >= 0)
    writer->Put(c.output_int[static_cast<std::size_t>(i)]);
  if (const int i = RegisterOf(name, "output_double"); i >= 0)
    writer->Put(c.output_double[static_cast<std::size_t>(i)]);
  if (name == "timestamp") writer->Put(c.time);
  if (name == "actual_q") PutAll(c.q, writer);
  if (name == "actual_qd") PutAll(c.v, writer);
  if (name == "target_qd") PutAll(c.set_point(), writer);
  if (name == "ft_raw_wrench") PutAll(c.wrench, writer);
  if (name == "robot_mode") writer->Put(c.robot_mode);
  if (name == "robot_status_bits")
    writer->Put((c.robot_mode != UrController::kPowerOff ? 1U : 0U) |
                (c.runtime == UrController::kPlaying ? 2U : 0U) | (c.freedrive ? 4U : 0U));
  if (name == "safety_status_bits") writer->Put(c.safety_bits);
  if (name == "target_speed_fraction") writer->Put(c.slider);
  if (name == "actual_digital_input_bits") writer->Put(c.inputs);
  if (name == "actual_TCP_pose") PutAll(c.tool(), writer);
  if (name == "tcp_offset") PutAll(c.tool_offset, writer);
  if (name == "payload") writer->Put(c.payload.value_or(0));
  if (name == "payload_cog")
    for (const double x : c.payload_cog) writer->Put(x);
  if (name == "runtime_state") writer->Put(static_cast<std::uint32_t>(c.runtime));
}

void RtdeServer::Cycle() {
  ++cycle_;
  for (auto& [link, session] : sessions_) {
    if (!session->started || session->outputs.empty() || cycle_ % session->divisor != 0) continue;
    PacketWriter writer(PacketType::kData);
    writer.Put(std::uint8_t{1});
    for (const std::string& name : session->outputs) Put(name, &writer);
    const auto bytes = writer.Finish();
    session->last.assign(bytes.begin(), bytes.end());
    send_(link, bytes);
  }
}

void RtdeServer::Repeat() {
  for (auto& [link, session] : sessions_)
    if (!session->last.empty()) send_(link, session->last);
}

}  // namespace predictor
