// Tests what other threads can find out about the calls into a controller's library.
#include "simulation/plugin_calls.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

namespace predictor {
namespace {

TEST(PluginCalls, NameTheLibraryOnlyWhileThisThreadRunsIt) {
  PluginCalls calls("/tmp/\x1b[2Jmine.so");
  EXPECT_EQ(PluginCall::Current().library, nullptr);
  {
    const PluginCall call(&calls, "compute");
    EXPECT_STREQ(PluginCall::Current().library, "/tmp/\\x1b[2Jmine.so");
    EXPECT_STREQ(PluginCall::Current().function, "compute");
    std::thread([] { EXPECT_EQ(PluginCall::Current().library, nullptr); }).join();
  }
  EXPECT_EQ(PluginCall::Current().library, nullptr);
}

TEST(PluginCalls, CountTheLooksThatSawTheSameCall) {
  PluginCalls calls("mine.so");
  EXPECT_FALSE(LookAtPluginCalls());
  {
    const PluginCall call(&calls, "create", PluginCall::Kind::kPreparation);
    EXPECT_FALSE(LookAtPluginCalls());  // it may just have begun
    for (int looks = 1; looks < 4; ++looks) {
      const auto seen = LookAtPluginCalls();
      ASSERT_TRUE(seen);
      EXPECT_EQ(seen->library, "mine.so");
      EXPECT_EQ(seen->function, "create");
      EXPECT_TRUE(seen->prepares);
      EXPECT_EQ(seen->looks, looks);
    }
  }
  EXPECT_FALSE(LookAtPluginCalls());
}

// A loop that calls the library repeatedly does not hang, even if each check finds the loop inside
// the library.
TEST(PluginCalls, CallsThatReturnAreNotLong) {
  PluginCalls calls("mine.so");
  for (int k = 0; k < 5; ++k) {
    const PluginCall call(&calls, "compute");
    EXPECT_FALSE(LookAtPluginCalls()) << k;
  }
}

TEST(PluginCalls, OfSeveralControllersTheLongestCallCounts) {
  PluginCalls first("first.so"), second("second.so");
  const PluginCall earlier(&second, "advance");
  LookAtPluginCalls();
  LookAtPluginCalls();
  const PluginCall later(&first, "compute");
  LookAtPluginCalls();
  const auto seen = LookAtPluginCalls();
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->library, "second.so");
  EXPECT_EQ(seen->function, "advance");
  EXPECT_EQ(seen->looks, 3);
  EXPECT_FALSE(seen->prepares);
}

TEST(PluginCalls, ACallThatReturnsAfterTheLookIsNotGivenUp) {
  PluginCalls calls("mine.so");
  EXPECT_FALSE(GiveUpPluginCall());
  {
    const PluginCall call(&calls, "compute");
    LookAtPluginCalls();
    ASSERT_TRUE(LookAtPluginCalls());
  }
  EXPECT_FALSE(GiveUpPluginCall());
  const PluginCall next(&calls, "compute");  // its end would hang otherwise
}

// The loop must not continue while another thread ends the program. The loop's thread then waits
// until the process ends, so the test leaves the thread and its data behind.
TEST(PluginCalls, ACallThatIsGivenUpNeverReturnsToTheLoop) {
  struct Loop {
    PluginCalls calls{"mine.so"};
    std::atomic<bool> is_inside{false}, may_return{false}, returned{false}, continued{false};
  };
  static Loop* const loop = new Loop;
  std::thread([] {
    {
      const PluginCall call(&loop->calls, "compute");
      loop->is_inside = true;
      while (!loop->may_return) std::this_thread::yield();
      loop->returned = true;
    }
    loop->continued = true;
  }).detach();
  while (!loop->is_inside) std::this_thread::yield();
  LookAtPluginCalls();
  ASSERT_TRUE(LookAtPluginCalls());
  ASSERT_TRUE(GiveUpPluginCall());
  loop->may_return = true;
  while (!loop->returned) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(loop->continued);
}

TEST(PluginCalls, StartTheWatchWithTheFirstLibrary) {
  int starts = 0;
  OnNextPlugin([&] { ++starts; });
  EXPECT_EQ(starts, 0);
  const PluginCalls first("first.so"), second("second.so");
  EXPECT_EQ(starts, 1);
}

}  // namespace
}  // namespace predictor
