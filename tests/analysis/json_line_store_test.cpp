#include "analysis/json_line_store.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
using Json = JsonLineStore::Json;

TEST(JsonLineStore, KeepsFinishedPiecesAfterTruncation) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "pieces.jsonl";
  {
    JsonLineStore store(file);
    EXPECT_FALSE(store.Find("a"));
    store.Add("a", {{"x", 0.1}});
    store.Add("b", {{"x", 0.2}});
  }
  // This is the state of the file if the program was killed while it wrote the second line.
  fs::resize_file(file, fs::file_size(file) - 4);
  {
    JsonLineStore store(file);
    ASSERT_TRUE(store.Find("a"));
    EXPECT_FALSE(store.Find("b"));
    store.Add("c", {{"x", 0.3}});
  }
  const JsonLineStore store(file);
  ASSERT_TRUE(store.Find("a") && store.Find("c"));
  EXPECT_EQ(store.Find("a")->at("x"), 0.1);
  EXPECT_EQ(store.Find("c")->at("x"), 0.3);
}

TEST(JsonLineStore, ReportsAFullDisk) {
  const test::TemporaryFolder folder;
  const auto add_without_room = [&] {
    JsonLineStore store(folder.path() / "pieces.jsonl");
    // The maximum size of a file [bytes] also applies to the file that receives the error message.
    const rlimit limit = {4000, 4000};
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_IGN);
    try {
      for (int k = 0; k < 100; ++k) store.Add(std::to_string(k), {{"x", std::string(100, 'x')}});
    } catch (const InputError& error) {
      std::fputs(error.what(), stderr);
      std::_Exit(0);
    }
    std::_Exit(1);
  };
  EXPECT_EXIT(add_without_room(), testing::ExitedWithCode(0), "disk with free space");
}

TEST(JsonLineStore, RefusesAFolderThatDoesNotExist) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(JsonLineStore(folder.path() / "no" / "pieces.jsonl"), InputError);
}

TEST(JsonLineStore, SkipsInvalidLines) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "pieces.jsonl";
  std::ofstream(file) << "no json\n[1]\n{\"key\": 3}\n{\"no key\": 3}\n\n{\"key\": \"x\"}\n";
  EXPECT_TRUE(JsonLineStore(file).Find("x"));
}

TEST(HexHash, IsFowlerNollVo) {
  EXPECT_EQ(HexHash(""), "cbf29ce484222325");
  EXPECT_EQ(HexHash("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(HexHash("foobar"), "85944171f73967e8");
}

}  // namespace
}  // namespace predictor
