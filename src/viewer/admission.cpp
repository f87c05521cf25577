#include "viewer/admission.h"

#include <openssl/crypto.h>
#include <sys/random.h>

#include <cstring>
#include <stdexcept>

namespace predictor {
namespace {

constexpr std::array<const char*, kRoles> kNames = {"look", "operator", "control"};
constexpr std::size_t kCodeBytes = 16;
constexpr std::size_t kTokenBytes = 32;
constexpr std::uint32_t kPins = 1'000'000;

void Fill(void* to, std::size_t bytes) {
  if (getrandom(to, bytes, 0) != static_cast<ssize_t>(bytes))
    throw std::runtime_error("The system gives no random numbers.");
}

// Takes the same time wherever the two differ; only their lengths may be told by it.
bool Same(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

const char* Name(Role role) { return kNames[static_cast<std::size_t>(role)]; }

std::optional<Role> RoleNamed(std::string_view name) {
  for (std::size_t i = 0; i < kRoles; ++i)
    if (name == kNames[i]) return static_cast<Role>(i);
  return {};
}

std::string RandomText(std::size_t bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::vector<unsigned char> random(bytes);
  Fill(random.data(), bytes);
  std::string text;
  std::uint32_t bits = 0;
  int count = 0;
  for (const unsigned char byte : random) {
    bits = bits << 8 | byte;
    for (count += 8; count >= 6; count -= 6) text += kDigits[bits >> (count - 6) & 63];
  }
  if (count > 0) text += kDigits[bits << (6 - count) & 63];
  return text;
}

Admission::Admission(bool code_once) : code_(RandomText(kCodeBytes)), code_once_(code_once) {}

std::optional<Admission::Grant> Admission::ByCode(std::string_view code) {
  if (!Same(code, code_) || (code_once_ && code_used_)) return {};
  code_used_ = true;
  return Grant{Role::kControl, IssueToken(Role::kControl)};
}

std::optional<Admission::Grant> Admission::ByPin(std::string_view pin, std::uint64_t now_ns) {
  std::optional<Role> role;
  for (std::size_t i = 0; i < kRoles; ++i) {
    Pin& p = pins_[i];
    const bool waits = p.tries > 0 && now_ns < p.end_ns;
    if (Same(pin, p.digits) && waits) role = static_cast<Role>(i);
  }
  if (role) {
    pins_[static_cast<std::size_t>(*role)] = {};
    return Grant{*role, IssueToken(*role)};
  }
  for (Pin& p : pins_)
    if (p.tries > 0) --p.tries;
  return {};
}

std::optional<Admission::Grant> Admission::ByToken(std::string_view token) const {
  const Grant* found = nullptr;
  for (const Grant& grant : tokens_)
    if (Same(token, grant.token)) found = &grant;
  return found ? std::optional(*found) : std::nullopt;
}

std::string Admission::IssuePin(Role role, std::uint64_t now_ns) {
  // The last incomplete stretch of 32-bit numbers is thrown again, or small pins were likelier.
  std::uint32_t random = 0;
  do Fill(&random, sizeof random);
  while (random >= UINT32_MAX / kPins * kPins);
  std::string digits = std::to_string(random % kPins);
  digits.insert(0, 6 - digits.size(), '0');
  for (std::size_t i = 0; i < kRoles; ++i)
    if (pins_[i].tries > 0 && pins_[i].digits == digits) pins_[i] = {};  // one pin, one meaning
  pins_[static_cast<std::size_t>(role)] = {digits, now_ns + kPinLife, kPinTries};
  return digits;
}

std::string Admission::IssueToken(Role role) {
  if (tokens_.size() == kMostTokens) tokens_.erase(tokens_.begin());
  tokens_.push_back({role, RandomText(kTokenBytes)});
  return tokens_.back().token;
}

}  // namespace predictor
