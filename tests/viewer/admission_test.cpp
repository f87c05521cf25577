#include "viewer/admission.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "viewer/address.h"
#include "viewer/leases.h"

namespace predictor::viewer {
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;
constexpr const char* kHere = "192.0.2.1";

std::string OtherPin(const std::string& pin) { return pin == "000000" ? "000001" : "000000"; }

TEST(Admission, TheCodeGivesControlAndATokenThatWorksAgain) {
  Admission admission(false, NewAdmissionSecret());
  const auto grant = admission.ByCode(admission.code());
  ASSERT_TRUE(grant);
  EXPECT_EQ(grant->role, Role::kControl);
  EXPECT_GE(grant->token.size(), 43u);  // 256 bits
  const auto again = admission.ByToken(grant->token);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->role, Role::kControl);
  EXPECT_EQ(again->token, grant->token);
  EXPECT_TRUE(admission.ByCode(admission.code()));
}

TEST(Admission, TheCodeIsValidOnceWithRealArms) {
  Admission admission(true, NewAdmissionSecret());
  EXPECT_FALSE(admission.ByCode("wrong"));
  EXPECT_TRUE(admission.ByCode(admission.code()));
  EXPECT_FALSE(admission.ByCode(admission.code()));
}

TEST(Admission, RefusesEverythingElse) {
  Admission admission(false, NewAdmissionSecret());
  EXPECT_FALSE(admission.ByCode(""));
  EXPECT_FALSE(admission.ByCode(admission.code() + "A"));
  EXPECT_FALSE(admission.ByCode(admission.code().substr(1)));
  EXPECT_FALSE(admission.ByToken(""));
  EXPECT_FALSE(admission.ByToken(admission.code()));
  EXPECT_FALSE(admission.ByPin("", kHere, 0));
  EXPECT_FALSE(admission.ByPin("000000", kHere, 0));
  const std::string token = admission.IssueToken(Role::kLook);
  EXPECT_FALSE(admission.ByCode(token));
  std::string other = token;
  other.back() = other.back() == 'A' ? 'E' : 'A';
  EXPECT_FALSE(admission.ByToken(other));
}

TEST(Admission, APinGrantsItsRoleOnce) {
  Admission admission(false, NewAdmissionSecret());
  for (const Role role : {Role::kLook, Role::kOperator, Role::kControl}) {
    const std::string pin = admission.IssuePin(role, 0);
    EXPECT_EQ(pin.size(), 6u);
    const auto grant = admission.ByPin(pin, kHere, kSecond);
    ASSERT_TRUE(grant);
    EXPECT_EQ(grant->role, role);
    EXPECT_EQ(admission.ByToken(grant->token)->role, role);
    EXPECT_FALSE(admission.ByPin(pin, kHere, kSecond));
  }
}

TEST(Admission, APinIsValidForTwoMinutes) {
  Admission admission(false, NewAdmissionSecret());
  const std::string early = admission.IssuePin(Role::kLook, 0);
  EXPECT_TRUE(admission.ByPin(early, kHere, 120 * kSecond - 1));
  const std::string late = admission.IssuePin(Role::kLook, 0);
  EXPECT_FALSE(admission.ByPin(late, kHere, 120 * kSecond));
}

TEST(Admission, APinIsInvalidAfterFiveWrongAttempts) {
  Admission admission(false, NewAdmissionSecret());
  std::string pin = admission.IssuePin(Role::kControl, 0);
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(admission.ByPin(OtherPin(pin), kHere, kSecond));
  EXPECT_TRUE(admission.ByPin(pin, kHere, kSecond));
  pin = admission.IssuePin(Role::kControl, 0);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(admission.ByPin(OtherPin(pin), kHere, kSecond));
  EXPECT_FALSE(admission.ByPin(pin, kHere, kSecond));
}

TEST(Admission, WrongAttemptsCountAgainstEveryValidPin) {
  Admission admission(false, NewAdmissionSecret());
  const std::string look = admission.IssuePin(Role::kLook, 0);
  const std::string control = admission.IssuePin(Role::kControl, 0);
  std::string wrong = "123456";
  while (wrong == look || wrong == control) wrong[0]++;
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(admission.ByPin(wrong, kHere, kSecond));
  EXPECT_FALSE(admission.ByPin(look, kHere, kSecond));
  EXPECT_FALSE(admission.ByPin(control, kHere, kSecond));
}

// The viewer may die and restart. Clients that were admitted must stay admitted, but other clients
// must not be admitted.
TEST(Admission, SurvivesARestartWithItsSecret) {
  const std::string secret = NewAdmissionSecret();
  const Admission before(false, secret);
  const std::string look = before.IssueToken(Role::kLook);
  const Admission after(false, secret);
  EXPECT_EQ(after.code(), before.code());
  ASSERT_TRUE(after.ByToken(look));
  EXPECT_EQ(after.ByToken(look)->role, Role::kLook);
  EXPECT_FALSE(Admission(false, NewAdmissionSecret()).ByToken(look));
  const Admission real(true, secret), real_again(true, secret);
  EXPECT_NE(real.code(), real_again.code());  // the old code may have been used
}

// An ended generation must stay ended if the viewer starts again. The end invalidates its tokens
// and the code, which a disconnected client may know.
TEST(Admission, ANewGenerationEndsTokensPinsAndTheSharedCode) {
  const std::string secret = NewAdmissionSecret();
  Admission before(false, secret);
  const std::string code = before.code();
  const std::string token = before.ByCode(code)->token, watch = before.IssueWatchToken();
  const std::string pin = before.IssuePin(Role::kLook, 0);
  before.Renew({1, 0});
  EXPECT_FALSE(before.ByPin(pin, kHere, kSecond));
  Admission after(false, secret, {1, 0});
  for (Admission* admission : {&before, &after}) {
    EXPECT_FALSE(admission->ByToken(token));
    EXPECT_TRUE(admission->MayWatch(watch));
    EXPECT_TRUE(admission->ByToken(before.IssueToken(Role::kLook)));
    EXPECT_FALSE(admission->ByCode(code));
    EXPECT_TRUE(admission->ByCode(before.code()));
    admission->Renew({0, 0});  // never back
    EXPECT_FALSE(admission->ByToken(token));
  }
  const std::string page = before.IssueToken(Role::kLook);
  before.Renew({1, 1});
  EXPECT_FALSE(before.MayWatch(watch));
  EXPECT_TRUE(before.ByToken(page));
}

// The program does not store revoked tokens in a list, so no list can become full.
TEST(Admission, AnyNumberOfGenerationsEnds) {
  const std::string secret = NewAdmissionSecret();
  Admission admission(false, secret);
  std::vector<std::string> tokens;
  for (std::uint32_t i = 1; i <= 1000; ++i) {
    tokens.push_back(admission.IssueToken(Role::kControl));
    admission.Renew({i, 0});
  }
  const Admission after(false, secret, admission.generations());
  for (const std::string& token : tokens) EXPECT_FALSE(after.ByToken(token));
}

// A token must be refused if any of its characters is changed, in particular the character of the
// role.
TEST(Admission, ATokenIsSigned) {
  const Admission admission(false, NewAdmissionSecret());
  const std::string token = admission.IssueToken(Role::kLook);
  for (std::size_t i = 0; i < token.size(); ++i)
    for (const char other : {'0', '1', '2', 'A', '_'}) {
      std::string changed = token;
      changed[i] = other;
      if (changed != token) {
        EXPECT_FALSE(admission.ByToken(changed)) << i << other;
      }
    }
  EXPECT_FALSE(admission.ByToken(token.substr(0, 23)));
  EXPECT_FALSE(admission.ByToken(token + "A"));
}

TEST(Admission, SecretsDiffer) {
  std::set<std::string> seen;
  for (int i = 0; i < 200; ++i) {
    Admission admission(false, NewAdmissionSecret());
    EXPECT_TRUE(seen.insert(admission.code()).second);
    EXPECT_TRUE(seen.insert(admission.IssueToken(Role::kLook)).second);
  }
  for (const std::string& text : seen)
    EXPECT_EQ(
        text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
        std::string::npos);
}

// PINs must have a uniform distribution, so the frequency of each digit at each position must be
// close to a tenth.
TEST(Admission, PinsAreUniform) {
  Admission admission(false, NewAdmissionSecret());
  const int count = 20000;
  int digits[6][10] = {};
  for (int i = 0; i < count; ++i) {
    const std::string pin = admission.IssuePin(Role::kLook, 0);
    for (std::size_t k = 0; k < 6; ++k) ++digits[k][pin[k] - '0'];
  }
  for (const auto& place : digits)
    for (const int n : place) EXPECT_NEAR(n, count / 10, 7 * 42.4);  // 7 standard deviations
}

// A client that guesses must use up its own attempts and not the attempts of other clients.
TEST(Admission, WrongAttemptsCountForTheirAddressOnly) {
  Admission admission(false, NewAdmissionSecret());
  const std::string pin = admission.IssuePin(Role::kLook, 0);
  for (int i = 0; i < 1000; ++i)
    EXPECT_FALSE(admission.ByPin(OtherPin(pin), "192.0.2.66", kSecond));
  EXPECT_FALSE(admission.ByPin(pin, "192.0.2.66", kSecond));
  EXPECT_TRUE(admission.ByPin(pin, kHere, kSecond));
}

TEST(Admission, ANewPinAllowsNewAttemptsAtThisPinOnly) {
  Admission admission(false, NewAdmissionSecret());
  const std::string control = admission.IssuePin(Role::kControl, 0);
  for (int i = 0; i < 5; ++i) admission.ByPin(OtherPin(control), kHere, kSecond);
  std::string look = admission.IssuePin(Role::kLook, kSecond);
  while (look == control) look = admission.IssuePin(Role::kLook, kSecond);
  EXPECT_FALSE(admission.ByPin(control, kHere, kSecond));
  EXPECT_TRUE(admission.ByPin(look, kHere, kSecond));
  EXPECT_TRUE(admission.ByPin(admission.IssuePin(Role::kControl, kSecond), kHere, kSecond));
}

// The table of addresses must be bounded, and so must the number of guesses from many addresses
// together.
TEST(Admission, ManyAddressesDoNotGetManyAttempts) {
  Admission admission(false, NewAdmissionSecret());
  const std::string pin = admission.IssuePin(Role::kLook, 0);
  EXPECT_FALSE(admission.ByPin(OtherPin(pin), kHere, kSecond));
  for (std::size_t i = 0; i < 2 * Admission::kMaxGuessers; ++i)
    admission.ByPin(OtherPin(pin), "2001:db8:0:" + std::to_string(i) + "::1", kSecond);
  EXPECT_FALSE(admission.ByPin(pin, "192.0.2.77", kSecond));  // no room for another address
  EXPECT_TRUE(admission.ByPin(pin, kHere, kSecond));          // had an entry before
  EXPECT_TRUE(admission.ByPin(admission.IssuePin(Role::kLook, kSecond), "192.0.2.77", kSecond));
}

TEST(Admission, CountsAllOfThisMachinesLoopbackAddressesAsOne) {
  EXPECT_EQ(SourceOf("127.0.0.1"), SourceOf("127.3.2.1"));
  EXPECT_EQ(SourceOf("127.0.0.1"), SourceOf("::1"));
  EXPECT_EQ(SourceOf("::ffff:127.0.0.1"), SourceOf("::1"));
  EXPECT_EQ(SourceOf("::ffff:192.0.2.7"), SourceOf("192.0.2.7"));
  EXPECT_EQ(SourceOf("fe80::1%eth0"), SourceOf("fe80::1"));
  EXPECT_NE(SourceOf("192.0.2.7"), SourceOf("192.0.2.8"));
}

// One machine may use all addresses that share its 64-bit prefix (RFC 4862).
TEST(Admission, CountsAnIpv6NetworkAsOneSource) {
  EXPECT_EQ(SourceOf("2001:db8::1"), "2001:db8::/64");
  EXPECT_EQ(SourceOf("2001:db8:0:0:1::"), "2001:db8::/64");
  EXPECT_EQ(SourceOf("2001:DB8:0:0:ffff:ffff:ffff:ffff%eth0"), "2001:db8::/64");
  EXPECT_NE(SourceOf("2001:db8:0:1::1"), SourceOf("2001:db8::1"));
  EXPECT_NE(SourceOf("fe80::1"), SourceOf("fe80::2"));  // of any networks
  Admission admission(false, NewAdmissionSecret());
  const std::string pin = admission.IssuePin(Role::kLook, 0);
  for (int i = 0; i < Admission::kPinTries; ++i)
    admission.ByPin(OtherPin(pin), "2001:db8::" + std::to_string(i), kSecond);
  EXPECT_EQ(admission.TakeLockedOut(), "2001:db8::/64");
  EXPECT_FALSE(admission.ByPin(pin, "2001:db8::77", kSecond));
  EXPECT_TRUE(admission.ByPin(pin, "2001:db8:0:1::77", kSecond));
}

TEST(Admission, ReportsOnceWhichAddressHasNoAttemptsLeft) {
  Admission admission(false, NewAdmissionSecret());
  for (int k = 0; k < 9; ++k) admission.ByPin("x", kHere, 1);
  EXPECT_EQ(admission.TakeLockedOut(), "");  // no PIN had been issued
  admission.IssuePin(Role::kLook, 1);
  for (int k = 0; k < Admission::kPinTries; ++k) {
    EXPECT_EQ(admission.TakeLockedOut(), "");
    admission.ByPin("x", kHere, 2);
  }
  EXPECT_EQ(admission.TakeLockedOut(), kHere);
  admission.ByPin("x", kHere, 2);
  EXPECT_EQ(admission.TakeLockedOut(), "");
}

// ---- leases -------------------------------------------------------------------------------------

TEST(Leases, OneHolderAtATime) {
  Leases leases;
  EXPECT_EQ(leases.Holder(LeaseKind::kControl), 0u);
  EXPECT_TRUE(leases.Take(LeaseKind::kControl, 1, 0));
  EXPECT_FALSE(leases.Take(LeaseKind::kControl, 2, 0));
  EXPECT_TRUE(leases.Take(LeaseKind::kOperator, 2, 0));
  EXPECT_TRUE(leases.Holds(LeaseKind::kControl, 1));
  EXPECT_FALSE(leases.Release(LeaseKind::kControl, 2));
  EXPECT_TRUE(leases.Release(LeaseKind::kControl, 1));
  EXPECT_TRUE(leases.Take(LeaseKind::kControl, 2, 0));
}

TEST(Leases, EndThreeSecondsAfterTheLastHeartbeat) {
  Leases leases;
  leases.Take(LeaseKind::kControl, 1, 0);
  leases.Heartbeat(1, 2 * kSecond);
  leases.Heartbeat(2, 4 * kSecond);  // the heartbeat is from another client
  EXPECT_FALSE(leases.Expire(5 * kSecond - 1));
  EXPECT_TRUE(leases.Holds(LeaseKind::kControl, 1));
  EXPECT_TRUE(leases.Expire(5 * kSecond));
  EXPECT_EQ(leases.Holder(LeaseKind::kControl), 0u);
  leases.Heartbeat(1, 5 * kSecond);  // too late: the lease is not restored automatically
  EXPECT_EQ(leases.Holder(LeaseKind::kControl), 0u);
}

TEST(Leases, AHeartbeatThatCameTooLateSavesNothing) {
  Leases leases;
  leases.Take(LeaseKind::kControl, 1, 0);
  leases.Heartbeat(1, 3 * kSecond);
  EXPECT_EQ(leases.Holder(LeaseKind::kControl), 0u);
}

TEST(Leases, AreReturnedToTheSameTokenInTime) {
  Leases leases;
  leases.Take(LeaseKind::kControl, 1, 0);
  EXPECT_FALSE(leases.Return(2, "token", kSecond));  // the holder is still connected
  leases.Leave(1, "token");
  EXPECT_FALSE(leases.Take(LeaseKind::kControl, 3, kSecond));
  EXPECT_FALSE(leases.Return(4, "other", kSecond));
  EXPECT_TRUE(leases.Return(5, "token", kSecond));
  EXPECT_TRUE(leases.Holds(LeaseKind::kControl, 5));
  leases.Leave(5, "token");
  EXPECT_FALSE(leases.Return(6, "token", 4 * kSecond));
  EXPECT_TRUE(leases.Take(LeaseKind::kControl, 3, 4 * kSecond));
}

TEST(Leases, AreRevokedAtTheConsole) {
  Leases leases;
  leases.Take(LeaseKind::kOperator, 1, 0);
  leases.Revoke(LeaseKind::kOperator);
  EXPECT_TRUE(leases.Take(LeaseKind::kOperator, 2, 0));
}

TEST(Leases, NeedARole) {
  EXPECT_FALSE(Leases::MayHold(Role::kLook, LeaseKind::kOperator));
  EXPECT_FALSE(Leases::MayHold(Role::kLook, LeaseKind::kControl));
  EXPECT_TRUE(Leases::MayHold(Role::kOperator, LeaseKind::kOperator));
  EXPECT_FALSE(Leases::MayHold(Role::kOperator, LeaseKind::kControl));
  EXPECT_TRUE(Leases::MayHold(Role::kControl, LeaseKind::kOperator));
  EXPECT_TRUE(Leases::MayHold(Role::kControl, LeaseKind::kControl));
}

}  // namespace
}  // namespace predictor::viewer
