// Who holds the right to command, and who that to be the operator: at most one client each.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "viewer/admission.h"

namespace predictor {

enum class LeaseKind : std::uint8_t { kControl, kOperator };
inline constexpr int kLeases = 2;
const char* Name(LeaseKind kind);  // "control", "operator"
std::optional<LeaseKind> LeaseNamed(std::string_view name);

// Time is handed in: monotonic clock [ns].
class Leases {
 public:
  static constexpr std::uint64_t kLife = 3'000'000'000;  // after the holder's last heartbeat [ns]

  // Whether a role may hold it at all.
  static bool MayHold(Role role, LeaseKind kind) {
    return kind == LeaseKind::kControl ? role == Role::kControl : role != Role::kLook;
  }

  // False if somebody else holds it. Taking what one holds is a heartbeat.
  bool Take(LeaseKind kind, std::uint32_t client, std::uint64_t now_ns);
  // Whether anything was let go.
  bool Release(LeaseKind kind, std::uint32_t client);
  void Heartbeat(std::uint32_t client, std::uint64_t now_ns);
  // The client has gone: its leases run out as they would, unless whoever shows the same token
  // comes back before.
  void Leave(std::uint32_t client, const std::string& token);
  // True if a lease went over to the client that came back with `token`.
  bool Return(std::uint32_t client, const std::string& token, std::uint64_t now_ns);
  // Ends what has run out; true if anything has.
  bool Expire(std::uint64_t now_ns);
  // At the console: whoever holds it, it is free.
  void Revoke(LeaseKind kind) { lease(kind) = {}; }

  // 0: nobody.
  std::uint32_t Holder(LeaseKind kind) const {
    return leases_[static_cast<std::size_t>(kind)].client;
  }
  bool Holds(LeaseKind kind, std::uint32_t client) const {
    return client != 0 && Holder(kind) == client;
  }

 private:
  struct Lease {
    std::uint32_t client = 0;
    std::uint64_t end_ns = 0;
    std::string left_token;  // of a holder who has gone
  };
  Lease& lease(LeaseKind kind) { return leases_[static_cast<std::size_t>(kind)]; }

  std::array<Lease, kLeases> leases_;
};

}  // namespace predictor
