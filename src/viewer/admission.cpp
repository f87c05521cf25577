#include "viewer/admission.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <sys/random.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

namespace predictor {
namespace {

constexpr std::array<const char*, kRoles> kNames = {"look", "operator", "control"};
constexpr std::size_t kCodeBytes = 16;
constexpr std::size_t kNonceBytes = 16;
constexpr std::size_t kTextOf16 = 22;  // length of 16 bytes as base64url
constexpr std::uint32_t kPins = 1'000'000;
constexpr int kWatch = kRoles;  // a token's purpose beside the roles

void Fill(void* to, std::size_t bytes) {
  if (getrandom(to, bytes, 0) != static_cast<ssize_t>(bytes))
    throw std::runtime_error("The system gives no random numbers.");
}

// Takes the same time wherever the two differ; only their lengths may be told by it.
bool Same(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string Base64Url(const unsigned char* data, std::size_t bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::string text;
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    bits = bits << 8 | data[i];
    for (count += 8; count >= 6; count -= 6) text += kDigits[bits >> (count - 6) & 63];
  }
  if (count > 0) text += kDigits[bits << (6 - count) & 63];
  return text;
}

}  // namespace

const char* Name(Role role) { return kNames[static_cast<std::size_t>(role)]; }

std::optional<Role> RoleNamed(std::string_view name) {
  for (std::size_t i = 0; i < kRoles; ++i)
    if (name == kNames[i]) return static_cast<Role>(i);
  return {};
}

std::string RandomText(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  Fill(random.data(), bytes);
  return Base64Url(random.data(), bytes);
}

Admission::Admission(bool code_once, std::string secret, std::vector<std::string> revoked)
    : secret_(std::move(secret)),
      revoked_(std::move(revoked)),
      code_(code_once ? RandomText(kCodeBytes) : SharedCode()),
      code_once_(code_once) {}

// The same in each process of a run, until somebody who may know it is thrown out.
std::string Admission::SharedCode() const {
  return Sign("code" + std::to_string(revoked_.size())).substr(0, kTextOf16);
}

std::string Admission::Sign(std::string_view what) const {
  std::array<unsigned char, EVP_MAX_MD_SIZE> mac{};
  unsigned size = 0;
  if (HMAC(EVP_sha256(), secret_.data(), static_cast<int>(secret_.size()),
           reinterpret_cast<const unsigned char*>(what.data()), what.size(), mac.data(),
           &size) == nullptr)
    throw std::runtime_error("The system's library signs nothing.");
  return Base64Url(mac.data(), size);
}

// Pages' tokens are of a generation, which ends when somebody is thrown out.
std::string Admission::SignFor(int purpose, std::string_view what) const {
  const std::string generation =
      purpose == kWatch ? "watch " : "page " + std::to_string(revoked_.size()) + " ";
  return Sign(generation + std::string(what));
}

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
  for (Pin& p : pins_) {
    if (p.tries == 0 || now_ns >= p.end_ns) continue;
    --p.tries;
    voided_ |= p.tries == 0;
  }
  return {};
}

// TEXT = nonce, purpose (a digit), MAC of both.
int Admission::PurposeOf(std::string_view token) const {
  constexpr std::size_t kSigned = kTextOf16 + 1;
  if (token.size() <= kSigned) return -1;
  const int purpose = token[kTextOf16] - '0';
  if (!Same(token.substr(kSigned), SignFor(purpose, token.substr(0, kSigned)))) return -1;
  if (std::find(revoked_.begin(), revoked_.end(), token.substr(0, kTextOf16)) != revoked_.end())
    return -1;
  return purpose;
}

std::optional<Admission::Grant> Admission::ByToken(std::string_view token) const {
  const int role = PurposeOf(token);
  if (role < 0 || role >= kRoles) return {};
  return Grant{static_cast<Role>(role), std::string(token)};
}

bool Admission::MayWatch(std::string_view token) const { return PurposeOf(token) == kWatch; }

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

std::string Admission::Revoke(std::string_view token) {
  revoked_.emplace_back(token.substr(0, kTextOf16));
  if (!code_once_) code_ = SharedCode();
  return revoked_.back();
}

std::string Admission::SignedToken(int purpose) const {
  const std::string what = RandomText(kNonceBytes) + std::to_string(purpose);
  return what + SignFor(purpose, what);
}

std::string Admission::IssueToken(Role role) const { return SignedToken(static_cast<int>(role)); }

std::string Admission::IssueWatchToken() const { return SignedToken(kWatch); }

}  // namespace predictor
