// Runs a fuzz target on every file of its corpus. Usage: NUMBER FOLDER [FOLDER...]. The first
// folder must contain exactly NUMBER inputs, so that a lost input is noticed.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz/target.h"

namespace {

int Replay(const char* folder) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    std::printf("%s\n", entry.path().c_str());
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    ++files;
  }
  std::printf("%d files in %s\n", files, folder);
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fputs("Usage: fuzz_TARGET NUMBER FOLDER [FOLDER...]\n", stderr), 2;
  const int expected = std::atoi(argv[1]);
  const int inputs = Replay(argv[2]);
  bool complete = inputs == expected;
  if (!complete)
    std::fprintf(stderr, "%d inputs, but tests/fuzz/CMakeLists.txt counts %d\n", inputs, expected);
  for (int i = 3; i < argc; ++i) complete = Replay(argv[i]) > 0 && complete;
  return complete ? 0 : 1;
}
