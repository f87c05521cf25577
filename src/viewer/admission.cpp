#include "viewer/admission.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <sys/random.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "viewer/address.h"

namespace predictor::viewer {
namespace {

constexpr std::array<const char*, kRoles> kNames = {"look", "operator", "control"};
constexpr std::size_t kCodeBytes = 16;
constexpr std::size_t kNonceBytes = 16;
constexpr std::size_t kTextOf16 = 22;  // length of 16 bytes as base64url
constexpr std::uint32_t kPins = 1'000'000;
constexpr int kWatch = kRoles;  // purpose of a token that gives no role

void Fill(void* to, std::size_t bytes) {
  if (getrandom(to, bytes, 0) != static_cast<ssize_t>(bytes))
    throw std::runtime_error("The system does not provide random numbers.");
}

// The comparison takes the same time regardless of where the texts differ, so it reveals at most
// the lengths of the texts.
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

Admission::Admission(bool code_once, std::string secret, Generations generations)
    : secret_(std::move(secret)),
      generations_(generations),
      code_(code_once ? RandomText(kCodeBytes) : SharedCode()),
      code_once_(code_once) {}

// The code is the same in each process of a run, until a client that may know it is removed.
std::string Admission::SharedCode() const {
  return Sign("code" + std::to_string(generations_.pages)).substr(0, kTextOf16);
}

std::string Admission::Sign(std::string_view what) const {
  std::array<unsigned char, EVP_MAX_MD_SIZE> mac{};
  unsigned size = 0;
  if (HMAC(EVP_sha256(), secret_.data(), static_cast<int>(secret_.size()),
           reinterpret_cast<const unsigned char*>(what.data()), what.size(), mac.data(),
           &size) == nullptr)
    throw std::runtime_error("The system's cryptographic library cannot create signatures.");
  return Base64Url(mac.data(), size);
}

std::string Admission::SignFor(int purpose, std::string_view what) const {
  const std::string generation = purpose == kWatch
                                     ? "watch " + std::to_string(generations_.watchers) + " "
                                     : "page " + std::to_string(generations_.pages) + " ";
  return Sign(generation + std::string(what));
}

std::optional<Admission::Grant> Admission::ByCode(std::string_view code) {
  if (!Same(code, code_) || (code_once_ && code_used_)) return {};
  code_used_ = true;
  return Grant{Role::kControl, IssueToken(Role::kControl)};
}

std::optional<Admission::Grant> Admission::ByPin(std::string_view pin, const std::string& address,
                                                 std::uint64_t now_ns) {
  const std::string source = SourceOf(address);
  const auto known = guesses_.find(source);
  const bool may_guess = known != guesses_.end() || guesses_.size() < kMaxGuessers;
  const Guesses guesses = known != guesses_.end() ? known->second : Guesses{};
  std::optional<Role> role;
  for (std::size_t i = 0; i < kRoles; ++i) {
    const bool waits = now_ns < pins_[i].end_ns && may_guess && guesses[i] < kPinTries;
    if (Same(pin, pins_[i].digits) && waits) role = static_cast<Role>(i);
  }
  if (role) {
    pins_[static_cast<std::size_t>(*role)] = {};
    return Grant{*role, IssueToken(*role)};
  }
  if (may_guess) CountWrongGuess(source, now_ns);
  return {};
}

void Admission::CountWrongGuess(const std::string& source, std::uint64_t now_ns) {
  for (std::size_t i = 0; i < kRoles; ++i) {
    if (now_ns >= pins_[i].end_ns) continue;
    std::uint8_t& wrong = guesses_[source][i];
    if (wrong >= kPinTries) continue;
    ++wrong;
    if (wrong == kPinTries) locked_out_ = source;
  }
}

// TEXT consists of a nonce, the purpose (a digit), and the MAC of both.
int Admission::PurposeOf(std::string_view token) const {
  constexpr std::size_t kSigned = kTextOf16 + 1;
  if (token.size() <= kSigned) return -1;
  const int purpose = token[kTextOf16] - '0';
  if (!Same(token.substr(kSigned), SignFor(purpose, token.substr(0, kSigned)))) return -1;
  return purpose;
}

std::optional<Admission::Grant> Admission::ByToken(std::string_view token) const {
  const int role = PurposeOf(token);
  if (role < 0 || role >= kRoles) return {};
  return Grant{static_cast<Role>(role), std::string(token)};
}

bool Admission::MayWatch(std::string_view token) const { return PurposeOf(token) == kWatch; }

std::string Admission::IssuePin(Role role, std::uint64_t now_ns) {
  // A number in the last, incomplete block of 32-bit numbers is drawn again. Without this rule,
  // small pins would be more likely.
  std::uint32_t random = 0;
  do Fill(&random, sizeof random);
  while (random >= UINT32_MAX / kPins * kPins);
  std::string digits = std::to_string(random % kPins);
  digits.insert(0, 6 - digits.size(), '0');
  for (Pin& pin : pins_)
    if (now_ns >= pin.end_ns || pin.digits == digits) pin = {};  // a pin must identify one role
  pins_[static_cast<std::size_t>(role)] = {};
  // The counts of wrong guesses are kept only for roles whose pin is still valid.
  for (auto& [source, guesses] : guesses_)
    for (std::size_t i = 0; i < kRoles; ++i)
      if (pins_[i].end_ns == 0) guesses[i] = 0;
  std::erase_if(guesses_, [](const auto& entry) { return entry.second == Guesses{}; });
  pins_[static_cast<std::size_t>(role)] = {digits, now_ns + kPinLife};
  return digits;
}

void Admission::Renew(const Generations& generations) {
  generations_.watchers = std::max(generations_.watchers, generations.watchers);
  if (generations.pages <= generations_.pages) return;
  generations_.pages = generations.pages;
  pins_ = {};
  if (!code_once_) code_ = SharedCode();
}

std::string Admission::SignedToken(int purpose) const {
  const std::string what = RandomText(kNonceBytes) + std::to_string(purpose);
  return what + SignFor(purpose, what);
}

std::string Admission::IssueToken(Role role) const { return SignedToken(static_cast<int>(role)); }

std::string Admission::IssueWatchToken() const { return SignedToken(kWatch); }

}  // namespace predictor::viewer
