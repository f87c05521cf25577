// Tests copies of recordings that do not contain the person.
#include "recording/share.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/error.h"
#include "recording/reader.h"
#include "recording/writer.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

constexpr const char* kScenario =
    "predictor: 1\n"
    "operator:\n"
    "  type: person\n"
    "  body: {height: 1.8371, mass: 81.29, sex: female}\n"
    "  stance: {ground: [0.98765, 0, -0.85], facing: 180 deg}\n";

std::string BytesOf(const std::string& file) {
  std::ostringstream bytes;
  bytes << std::ifstream(file, std::ios::binary).rdbuf();
  return bytes.str();
}

RecordingHeader MadeHeader() {
  RecordingHeader header;
  header.scenario_yaml = kScenario;
  header.scenario_name = "made up";
  header.dt = 1e-3;
  header.labels = {{"pseudonym", "K7QM2XPX"}, {"condition", "real"}, {"consent", "version-3"}};
  return header;
}

// The header is stored twice, and chunks are compressed. Neither the header nor the chunks may
// contain a byte of the person's data.
TEST(Share, LeavesNoByteOfThePerson) {
  const test::TemporaryFolder folder;
  const std::string in = folder / "in.mcap", out = folder / "out.mcap";
  {
    RecordingWriter writer(in, MadeHeader());
    for (std::uint64_t tick = 1; tick <= 2000; ++tick) {
      TickRecord record{};
      record.tick = tick;
      writer.Add(record);
    }
    writer.AddEvent("K7QM2XPX felt dizzy", 1000);
    writer.Close();
  }
  const char* const personal[] = {"1.8371", "81.29", "female", "0.98765", "K7QM2XPX", "version-3"};
  const std::string before = BytesOf(in);
  for (const char* word : personal) {
    EXPECT_NE(before.find(word), std::string::npos) << word;
  }
  const std::vector<std::string> removed = WriteShared(in, out);
  const std::string after = BytesOf(out);
  for (const char* word : personal) EXPECT_EQ(after.find(word), std::string::npos) << word;
  RecordingReader reader(out);
  EXPECT_EQ(reader.count(), 2000u);
  EXPECT_TRUE(reader.events().empty());
  EXPECT_EQ(reader.header().labels, (std::map<std::string, std::string>{{"condition", "real"}}));
  EXPECT_NE(reader.header().scenario_yaml.find("type: person"), std::string::npos);
  EXPECT_EQ(removed, (std::vector<std::string>{"operator.body", "operator.stance", "label consent",
                                               "label pseudonym", "1 markers"}));
  reader.Check();
}

TEST(Share, RefusesASimulatedBody) {
  RecordingHeader header = MadeHeader();
  header.scenario_yaml += "  embodied: true\n";
  EXPECT_THROW(RemovePerson(&header), InputError);
}

}  // namespace
}  // namespace predictor
