#include "core/contained_thread.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace predictor {
namespace {

TEST(ContainedThread, EndsAloneAndReportsTheReason) {
  std::string why, name(16, '\0');
  ContainedThread(
      "a thread",
      [&] {
        pthread_getname_np(pthread_self(), name.data(), name.size());
        throw std::runtime_error("no more paper");
      },
      [&](const char* reason) { why = reason; })
      .join();
  EXPECT_EQ(why, "no more paper");
  EXPECT_STREQ(name.c_str(), "a thread");
}

TEST(ContainedThread, ContainsNonStandardExceptions) {
  std::string why;
  ContainedThread(
      "a thread", [] { throw 7; }, [&](const char* reason) { why = reason; })
      .join();
  EXPECT_EQ(why, "an exception of an unknown type");
}

TEST(ContainedThread, ContainsWhatTheReportThrows) {
  int reports = 0;
  ContainedThread(
      "a thread", [] { throw std::runtime_error("one"); },
      [&](const char*) {
        ++reports;
        throw std::runtime_error("two");
      })
      .join();
  EXPECT_EQ(reports, 1);
}

}  // namespace
}  // namespace predictor
