// Who may come in: codes, pins typed by hand, tokens. No sockets here; time is handed in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace predictor {

// What a client may do: look (and stop), lend a hand too, or command as well.
enum class Role : std::uint8_t { kLook, kOperator, kControl };
inline constexpr int kRoles = 3;
const char* Name(Role role);  // "look", "operator", "control"
std::optional<Role> RoleNamed(std::string_view name);

// Uniform random bytes of the system's generator, as base64url. Throws std::runtime_error.
std::string RandomText(std::size_t bytes);

// What a run keeps for its viewer, so that whoever was admitted stays so if that starts again.
inline std::string NewAdmissionSecret() { return RandomText(32); }

class Admission {
 public:
  static constexpr std::uint64_t kPinLife = 120'000'000'000;  // [ns]
  static constexpr int kPinTries = 5;

  static constexpr std::size_t kMostRevoked = 256;
  static constexpr std::size_t kLongestKey = 32;  // of what Revoke returns

  // `secret`: NewAdmissionSecret(). code_once: the code admits one client only, as with real arms;
  // then it is another with each start. `revoked`: what Revoke told earlier ones of this secret.
  Admission(bool code_once, std::string secret, std::vector<std::string> revoked = {});

  struct Grant {
    Role role = Role::kLook;
    std::string token;
  };
  // Trades the code, a pin or a token for a grant; nothing if it is wrong, used up or too old.
  std::optional<Grant> ByCode(std::string_view code);
  std::optional<Grant> ByPin(std::string_view pin, std::uint64_t now_ns);
  std::optional<Grant> ByToken(std::string_view token) const;

  // 128 bits as base64url; gives the role control.
  const std::string& code() const { return code_; }
  // Six digits that give `role` to the first who types them; the role's former pin is void. A
  // wrong guess counts against every pin that waits.
  std::string IssuePin(Role role, std::uint64_t now_ns);
  // A random number and the role, signed with the secret: 256 bits of HMAC-SHA-256.
  std::string IssueToken(Role role) const;
  // One for an address that other programs keep (Foxglove's): it opens their stream of data and
  // nothing else, no page, no model, not even a stop. ByToken knows it not.
  std::string IssueWatchToken() const;
  bool MayWatch(std::string_view token) const;
  // The token is good for nothing any more, nor is any page's token issued before (whoever is
  // thrown out may have fetched several), nor a code that several may use: there is a new one.
  // Returns the key by which others of this secret are told.
  std::string Revoke(std::string_view token);
  // Whether pins have become void by wrong guesses since the last call.
  bool TakeVoided() { return std::exchange(voided_, false); }

 private:
  struct Pin {
    std::string digits;
    std::uint64_t end_ns = 0;
    int tries = 0;  // left
  };

  std::string Sign(std::string_view what) const;
  std::string SignFor(int purpose, std::string_view what) const;
  std::string SignedToken(int purpose) const;
  // What a token of ours is for: a role's number, or kWatch. −1: it is none of ours, or revoked.
  int PurposeOf(std::string_view token) const;
  std::string SharedCode() const;

  std::string secret_;
  std::vector<std::string> revoked_;
  std::string code_;
  bool code_once_, code_used_ = false, voided_ = false;
  std::array<Pin, kRoles> pins_;
};

}  // namespace predictor
