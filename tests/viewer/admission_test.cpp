#include "viewer/admission.h"

#include <gtest/gtest.h>

#include <set>

#include "viewer/leases.h"

namespace predictor {
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

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

TEST(Admission, TheCodeIsGoodOnceWithRealArms) {
  Admission admission(true, NewAdmissionSecret());
  EXPECT_FALSE(admission.ByCode("wrong"));
  EXPECT_TRUE(admission.ByCode(admission.code()));
  EXPECT_FALSE(admission.ByCode(admission.code()));
}

TEST(Admission, NothingElseComesIn) {
  Admission admission(false, NewAdmissionSecret());
  EXPECT_FALSE(admission.ByCode(""));
  EXPECT_FALSE(admission.ByCode(admission.code() + "A"));
  EXPECT_FALSE(admission.ByCode(admission.code().substr(1)));
  EXPECT_FALSE(admission.ByToken(""));
  EXPECT_FALSE(admission.ByToken(admission.code()));
  EXPECT_FALSE(admission.ByPin("", 0));
  EXPECT_FALSE(admission.ByPin("000000", 0));
  const std::string token = admission.IssueToken(Role::kLook);
  EXPECT_FALSE(admission.ByCode(token));
  std::string other = token;
  other.back() = other.back() == 'A' ? 'E' : 'A';
  EXPECT_FALSE(admission.ByToken(other));
}

TEST(Admission, APinGivesItsRoleOnce) {
  Admission admission(false, NewAdmissionSecret());
  for (const Role role : {Role::kLook, Role::kOperator, Role::kControl}) {
    const std::string pin = admission.IssuePin(role, 0);
    EXPECT_EQ(pin.size(), 6u);
    const auto grant = admission.ByPin(pin, kSecond);
    ASSERT_TRUE(grant);
    EXPECT_EQ(grant->role, role);
    EXPECT_EQ(admission.ByToken(grant->token)->role, role);
    EXPECT_FALSE(admission.ByPin(pin, kSecond));
  }
}

TEST(Admission, APinIsGoodForTwoMinutes) {
  Admission admission(false, NewAdmissionSecret());
  const std::string early = admission.IssuePin(Role::kLook, 0);
  EXPECT_TRUE(admission.ByPin(early, 120 * kSecond - 1));
  const std::string late = admission.IssuePin(Role::kLook, 0);
  EXPECT_FALSE(admission.ByPin(late, 120 * kSecond));
}

TEST(Admission, APinIsVoidAfterFiveWrongTries) {
  Admission admission(false, NewAdmissionSecret());
  std::string pin = admission.IssuePin(Role::kControl, 0);
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(admission.ByPin(OtherPin(pin), kSecond));
  EXPECT_TRUE(admission.ByPin(pin, kSecond));
  pin = admission.IssuePin(Role::kControl, 0);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(admission.ByPin(OtherPin(pin), kSecond));
  EXPECT_FALSE(admission.ByPin(pin, kSecond));
}

TEST(Admission, WrongTriesCountAgainstEveryPinThatWaits) {
  Admission admission(false, NewAdmissionSecret());
  const std::string look = admission.IssuePin(Role::kLook, 0);
  const std::string control = admission.IssuePin(Role::kControl, 0);
  std::string wrong = "123456";
  while (wrong == look || wrong == control) wrong[0]++;
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(admission.ByPin(wrong, kSecond));
  EXPECT_FALSE(admission.ByPin(look, kSecond));
  EXPECT_FALSE(admission.ByPin(control, kSecond));
}

// The viewer may die and start again: who was in stays in, and nobody else.
TEST(Admission, OutlivesAStartByItsSecret) {
  const std::string secret = NewAdmissionSecret();
  const Admission before(false, secret);
  const std::string look = before.IssueToken(Role::kLook);
  const Admission after(false, secret);
  EXPECT_EQ(after.code(), before.code());
  ASSERT_TRUE(after.ByToken(look));
  EXPECT_EQ(after.ByToken(look)->role, Role::kLook);
  EXPECT_FALSE(Admission(false, NewAdmissionSecret()).ByToken(look));
  const Admission real(true, secret), real_again(true, secret);
  EXPECT_NE(real.code(), real_again.code());  // it may have been used
}

// Who is thrown out stays out, also if the viewer starts again: token, and the code that it may
// know.
TEST(Admission, WhatIsRevokedStaysSo) {
  const std::string secret = NewAdmissionSecret();
  Admission before(false, secret);
  const std::string code = before.code();
  const std::string out = before.ByCode(code)->token, in = before.ByCode(code)->token;
  const std::string key = before.Revoke(out);
  EXPECT_LE(key.size(), Admission::kLongestKey);
  Admission after(false, secret, {key});
  for (Admission* admission : {&before, &after}) {
    EXPECT_FALSE(admission->ByToken(out));
    EXPECT_FALSE(admission->ByToken(in));  // it may be in the same hands
    EXPECT_TRUE(admission->ByToken(before.IssueToken(Role::kLook)));
    EXPECT_FALSE(admission->ByCode(code));
    EXPECT_TRUE(admission->ByCode(before.code()));
  }
}

// No character of a token can be changed, that of the role least of all.
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

// Pins are uniform: no digit at any place is far from a tenth.
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
  leases.Heartbeat(2, 4 * kSecond);  // of another client
  EXPECT_FALSE(leases.Expire(5 * kSecond - 1));
  EXPECT_TRUE(leases.Holds(LeaseKind::kControl, 1));
  EXPECT_TRUE(leases.Expire(5 * kSecond));
  EXPECT_EQ(leases.Holder(LeaseKind::kControl), 0u);
  leases.Heartbeat(1, 5 * kSecond);  // too late: nothing comes back by itself
  EXPECT_EQ(leases.Holder(LeaseKind::kControl), 0u);
}

TEST(Leases, AHeartbeatThatCameTooLateSavesNothing) {
  Leases leases;
  leases.Take(LeaseKind::kControl, 1, 0);
  leases.Heartbeat(1, 3 * kSecond);
  EXPECT_EQ(leases.Holder(LeaseKind::kControl), 0u);
}

TEST(Leases, GoBackToWhoeverReturnsWithTheSameTokenInTime) {
  Leases leases;
  leases.Take(LeaseKind::kControl, 1, 0);
  EXPECT_FALSE(leases.Return(2, "token", kSecond));  // the holder is still there
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

TEST(Admission, TellsOnceWhenGuessesVoidedAPin) {
  Admission admission(false, NewAdmissionSecret());
  for (int k = 0; k < 9; ++k) admission.ByPin("x", 1);
  EXPECT_FALSE(admission.TakeVoided());  // none waited
  admission.IssuePin(Role::kLook, 1);
  for (int k = 0; k < Admission::kPinTries; ++k) {
    EXPECT_FALSE(admission.TakeVoided());
    admission.ByPin("x", 2);
  }
  EXPECT_TRUE(admission.TakeVoided());
  EXPECT_FALSE(admission.TakeVoided());
}

}  // namespace
}  // namespace predictor
