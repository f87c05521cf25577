// Tests a recording in virtual time on a disk that becomes full. The tests check the message and
// the readable content.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>

#include "recording/reader.h"
#include "recording/recover.h"
#include "recording/samples.h"
#include "recording/writer.h"

namespace predictor {
namespace {

using namespace recording_test;

// Writes until an error occurs and stores the number of ticks. Returns the error message, or "" if
// no error occurs.
std::string WriteUntilFull(const std::string& path, std::uint64_t* ticks) {
  RecordingWriter writer(path, SampleHeader());
  try {
    for (std::uint64_t tick = 1; tick <= 60'000; ++tick) writer.Add(SampleTick(tick));
    writer.Close();
  } catch (const RecordingError& error) {
    *ticks = writer.ticks();
    writer.Add(SampleTick(70'000));  // the writer ignores this tick
    writer.Close();
    return error.what();
  }
  return "";
}

void ExpectReadable(const std::string& path, const std::string& message, std::uint64_t ticks,
                    const std::string& why, const Folder& folder) {
  EXPECT_NE(message.find(why), std::string::npos) << message;
  EXPECT_NE(message.find(" " + std::to_string(ticks) + " ticks were stored"), std::string::npos)
      << message;
  EXPECT_GT(ticks, 500u);
  RecordingReader reader(path);
  EXPECT_TRUE(reader.complete()) << reader.problem();
  EXPECT_EQ(reader.count(), ticks);
  reader.Check();
  TickRecord record;
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    ASSERT_TRUE(reader.Next(&record));
    ASSERT_TRUE(Same(record, SampleTick(tick)));
  }
  EXPECT_EQ(Recover(path, folder.File("out.mcap")).ticks, ticks);
}

TEST(FullDisk, OfFourMegabytes) {
  const Folder folder;
  if (::mount("none", folder.path().c_str(), "tmpfs", 0, "size=4m") != 0)
    GTEST_SKIP() << "Mounting a file system of 4 MB is not allowed here: " << std::strerror(errno)
                 << ". FileSizeLimit.* of the program stand in.";
  const Folder other;
  std::uint64_t ticks = 0;
  const std::string message = WriteUntilFull(folder.File("a.mcap"), &ticks);
  EXPECT_NO_FATAL_FAILURE(
      ExpectReadable(folder.File("a.mcap"), message, ticks, "No space left on device", other));
  EXPECT_LT(std::filesystem::file_size(folder.File("a.mcap")), 4U << 20U);
  EXPECT_GT(std::filesystem::file_size(folder.File("a.mcap")), 2U << 20U);
  EXPECT_EQ(::umount(folder.path().c_str()), 0);
}

}  // namespace
}  // namespace predictor
