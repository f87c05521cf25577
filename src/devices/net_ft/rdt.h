// Reads and writes the big-endian datagrams of Raw Data Transfer (RDT), which ATI's Net F/T and
// Axia and OnRobot's HEX and OptoForce boxes use. This code does not use the heap.
//
// Sources: ATI, Net F/T Manual 9610-05-1022 (section 9, "UDP interface using RDT"); OnRobot, HEX/QC
// compute box manual ("UDP"), which describes the same frame with other commands.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/types.h"

namespace predictor::rdt {

inline constexpr std::uint16_t kPort = 49152;
inline constexpr std::size_t kRequestBytes = 8, kRecordBytes = 36;

enum class Command : std::uint16_t {
  kStop = 0x0000,
  kStream = 0x0002,  // starts a stream without end, or of this number of records
  kBias = 0x0042,    // ATI: sets the current reading to zero; OnRobot: count 0xFF sets, 0 clears
  kFilter = 0x0081,  // OnRobot: number of the cut-off frequency, in `count`
  kPeriod = 0x0082,  // OnRobot: interval between records [ms], in `count`
};

// A client's request.
struct Request {
  Command command = Command::kStop;
  std::uint32_t count = 0;  // number of records (0: without end), or the command's parameter
};

// A sensor's record.
struct Record {
  std::uint32_t sequence = 0;            // number of this datagram; wraps
  std::uint32_t sample = 0;              // number of the sensor's internal sample; wraps
  std::uint32_t status = 0;              // 0: no error
  std::array<std::int32_t, 6> counts{};  // Fx Fy Fz Tx Ty Tz
};

std::array<std::byte, kRequestBytes> Encode(const Request& request) noexcept;
std::array<std::byte, kRecordBytes> Encode(const Record& record) noexcept;
// Returns no value if the size or the header is wrong.
std::optional<Request> DecodeRequest(std::span<const std::byte> bytes) noexcept;
std::optional<Record> DecodeRecord(std::span<const std::byte> bytes) noexcept;

// ATI's status word has a bit for an exceeded range and a bit that every error sets (manual,
// section 17.1, "System Status Code").
inline constexpr std::uint32_t kSaturated = 0x00020000;  // force or torque out of range
inline constexpr std::uint32_t kAnyError = 0x80000000;   // set with every error

// The status of OnRobot and OptoForce sensors is in the lower half of the word. The layout of the
// status word of OptoForce's 6-axis sensors. OptoForce's own clients treat every value except 0 as
// an error.
inline constexpr std::uint32_t kOverload = 0x000003F0;  // Tz Ty Tx Fz Fy Fx, from bit 4 upwards
// These three bits have the values 1 (not detected), 2 (failure) and 4 (temperature).
inline constexpr int kSensorErrorShift = 10;
inline constexpr int kDaqErrorShift = 13;  // three bits: 1 unit itself, 2 communication

}  // namespace predictor::rdt
