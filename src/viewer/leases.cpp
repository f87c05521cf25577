#include "viewer/leases.h"

namespace predictor::viewer {

const char* Name(LeaseKind kind) { return kind == LeaseKind::kControl ? "control" : "operator"; }

std::optional<LeaseKind> LeaseNamed(std::string_view name) {
  if (name == "control") return LeaseKind::kControl;
  if (name == "operator") return LeaseKind::kOperator;
  return {};
}

bool Leases::Take(LeaseKind kind, std::uint32_t client, std::uint64_t now_ns) {
  Expire(now_ns);
  Lease& it = lease(kind);
  if (it.client != 0 && it.client != client) return false;
  it = {client, now_ns + kLife, {}};
  return true;
}

bool Leases::Release(LeaseKind kind, std::uint32_t client) {
  if (!Holds(kind, client)) return false;
  lease(kind) = {};
  return true;
}

void Leases::Heartbeat(std::uint32_t client, std::uint64_t now_ns) {
  Expire(now_ns);
  for (Lease& it : leases_)
    if (it.client == client) it.end_ns = now_ns + kLife;
}

void Leases::Leave(std::uint32_t client, const std::string& token) {
  for (Lease& it : leases_)
    if (it.client == client) it.left_token = token;
}

bool Leases::Return(std::uint32_t client, const std::string& token, std::uint64_t now_ns) {
  Expire(now_ns);
  bool returned = false;
  for (Lease& it : leases_) {
    if (it.left_token.empty() || it.left_token != token) continue;
    it = {client, now_ns + kLife, {}};
    returned = true;
  }
  return returned;
}

bool Leases::Expire(std::uint64_t now_ns) {
  bool expired = false;
  for (Lease& it : leases_) {
    if (it.client == 0 || now_ns < it.end_ns) continue;
    it = {};
    expired = true;
  }
  return expired;
}

}  // namespace predictor::viewer
