#include "core/file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

class WholeFile : public testing::Test {
 protected:
  const test::TemporaryFolder temporary_;
  const fs::path& folder_ = temporary_.path();
};

TEST_F(WholeFile, IsReadAsItWasWritten) {
  // Longer than the pieces in which files are read, and with every byte.
  for (const std::size_t size : {0u, 1u, 65536u, 200001u}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i % 251);
    WriteWholeFile(folder_ / "bytes", bytes);
    EXPECT_EQ(ReadWholeFile(folder_ / "bytes"), bytes) << size;
  }
}

TEST_F(WholeFile, IsReadUpToTheLimit) {
  WriteWholeFile(folder_ / "digits", "0123456789");
  EXPECT_EQ(ReadWholeFile(folder_ / "digits", 4), "0123");
  EXPECT_EQ(ReadWholeFile(folder_ / "digits", 10), "0123456789");
  EXPECT_EQ(ReadWholeFile(folder_ / "digits", 11), "0123456789");
}

TEST_F(WholeFile, IsReplaced) {
  WriteWholeFile(folder_ / "text", "a long text");
  WriteWholeFile(folder_ / "text", "short");
  EXPECT_EQ(ReadWholeFile(folder_ / "text"), "short");
}

TEST_F(WholeFile, ThatIsMissingOrAFolderIsRefused) {
  EXPECT_THROW(ReadWholeFile(folder_ / "missing"), InputError);
  EXPECT_THROW(ReadWholeFile(folder_), InputError);
  EXPECT_THROW(WriteWholeFile(folder_, "text"), InputError);
  EXPECT_THROW(WriteWholeFile(folder_ / "missing" / "text", "text"), InputError);
  EXPECT_THROW(WriteWholeFile("/dev/full", "text"), InputError);
}

}  // namespace
}  // namespace predictor
