// The leases for control and for acting as operator. At most one client holds each lease.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "viewer/admission.h"

namespace predictor::viewer {

enum class LeaseKind : std::uint8_t { kControl, kOperator };
inline constexpr int kLeases = 2;
const char* Name(LeaseKind kind);  // "control", "operator"
std::optional<LeaseKind> LeaseNamed(std::string_view name);

// The caller passes the time of the monotonic clock [ns].
class Leases {
 public:
  // The lease lives for this time after the holder's last heartbeat [ns].
  static constexpr std::uint64_t kLife = 3'000'000'000;

  // Returns whether a role is allowed to hold this lease.
  static bool MayHold(Role role, LeaseKind kind) {
    return kind == LeaseKind::kControl ? role == Role::kControl : role != Role::kLook;
  }

  // Returns false if another client holds it. If the holder takes the lease again, this counts as a
  // heartbeat.
  bool Take(LeaseKind kind, std::uint32_t client, std::uint64_t now_ns);
  // Returns whether a lease was released.
  bool Release(LeaseKind kind, std::uint32_t client);
  void Heartbeat(std::uint32_t client, std::uint64_t now_ns);
  // The client has disconnected. The leases of this client expire normally, unless a client with
  // the same token reconnects earlier.
  void Leave(std::uint32_t client, const std::string& token);
  // Returns true if a lease was transferred to the client that reconnected with `token`.
  bool Return(std::uint32_t client, const std::string& token, std::uint64_t now_ns);
  // Ends expired leases. Returns whether at least one lease had expired.
  bool Expire(std::uint64_t now_ns);
  // Frees the lease, regardless of its holder. The operator at the console uses this.
  void Revoke(LeaseKind kind) { lease(kind) = {}; }

  // Returns 0 if there is no holder.
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
    std::string left_token;  // token of a holder that has disconnected
  };
  Lease& lease(LeaseKind kind) { return leases_[static_cast<std::size_t>(kind)]; }

  std::array<Lease, kLeases> leases_;
};

}  // namespace predictor::viewer
