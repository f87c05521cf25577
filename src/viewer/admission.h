// Admits clients by codes, typed pins, and tokens. This module uses no sockets, and the caller
// passes the time.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace predictor::viewer {

// A client's permissions. The first role may look and stop, the second may also act as operator,
// and the third may also command.
enum class Role : std::uint8_t { kLook, kOperator, kControl };
inline constexpr int kRoles = 3;
const char* Name(Role role);  // "look", "operator", "control"
std::optional<Role> RoleNamed(std::string_view name);

// Returns uniform random bytes from the system's generator, as base64url. Throws
// std::runtime_error.
std::string RandomText(std::size_t bytes);

// Returns a state that the run's process keeps for its viewer, so that admitted clients stay
// admitted if the viewer restarts.
inline std::string NewAdmissionSecret() { return RandomText(32); }

// Tokens are valid only in the generation in which they were issued. The run's process keeps both
// numbers, so that expired tokens do not become valid again when the viewer's process is replaced.
struct Generations {
  std::uint32_t pages = 0, watchers = 0;
  friend bool operator==(const Generations&, const Generations&) = default;
};

class Admission {
 public:
  static constexpr std::uint64_t kPinLife = 120'000'000'000;  // [ns]
  static constexpr int kPinTries = 5;                         // wrong guesses allowed per address
  static constexpr std::size_t kMaxGuessers = 256;            // addresses with wrong guesses

  // `secret` is a NewAdmissionSecret(). If `code_once` is true, as with real arms, the code admits
  // only one client and changes with each start.
  Admission(bool code_once, std::string secret, Generations generations = {});

  struct Grant {
    Role role = Role::kLook;
    std::string token;
  };
  // These functions exchange the code, a pin or a token for a grant. The functions return no value
  // if the code, pin or token is wrong, already used, or expired.
  std::optional<Grant> ByCode(std::string_view code);
  // `address` is the client's numeric address.
  std::optional<Grant> ByPin(std::string_view pin, const std::string& address,
                             std::uint64_t now_ns);
  std::optional<Grant> ByToken(std::string_view token) const;

  // Returns 128 bits as base64url, which grant the role control.
  const std::string& code() const { return code_; }
  // Returns six digits that grant `role` to the first client that enters them. The role's previous
  // pin becomes invalid. An address that guessed wrongly kPinTries times can no longer use this
  // pin, but the pin stays valid for all other addresses. Once kMaxGuessers addresses have guessed
  // wrongly, no further address can use a pin, so that many addresses do not allow many guesses.
  std::string IssuePin(Role role, std::uint64_t now_ns);
  // Returns a random number and the role, signed with the secret: 256 bits of HMAC-SHA-256.
  std::string IssueToken(Role role) const;
  // Returns a token for an address that other programs store (Foxglove's). This token only opens
  // the data stream of such a program. The token gives no access to a page or a model, and does not
  // allow a stop request. ByToken does not accept this token.
  std::string IssueWatchToken() const;
  bool MayWatch(std::string_view token) const;
  // Ends all generations that are older than the given ones. A new generation of pages invalidates
  // all page tokens and waiting pins, and replaces a code that several clients may use. A
  // generation lower than the present one has no effect.
  void Renew(const Generations& generations);
  const Generations& generations() const { return generations_; }
  // Returns the address that has used its last guess since the previous call, or "" if there was
  // none.
  std::string TakeLockedOut() { return std::exchange(locked_out_, {}); }

 private:
  struct Pin {
    std::string digits;
    std::uint64_t end_ns = 0;  // 0: no pin
  };
  using Guesses = std::array<std::uint8_t, kRoles>;  // number of wrong guesses for each role's pin

  std::string Sign(std::string_view what) const;
  std::string SignFor(int purpose, std::string_view what) const;
  std::string SignedToken(int purpose) const;
  void CountWrongGuess(const std::string& source, std::uint64_t now_ns);
  // Returns the purpose of a token that this object issued: a role's number, or kWatch, or −1 if
  // the token is unknown or expired.
  int PurposeOf(std::string_view token) const;
  std::string SharedCode() const;

  std::string secret_;
  Generations generations_;
  std::string code_;
  bool code_once_, code_used_ = false;
  std::array<Pin, kRoles> pins_;
  std::map<std::string, Guesses> guesses_;  // key: SourceOf
  std::string locked_out_;
};

}  // namespace predictor::viewer
