// Compares the fake controller with captured bytes and lines.
#include <gtest/gtest.h>

#include <string>

#include "devices/ur_bench.h"

namespace predictor {
namespace {

Bytes Heard(UrBench* bench, Stream* stream, double time = 0.01) {
  bench->network.Pass(time);
  Bytes all(100000);
  const int n = stream->Read(all);
  all.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return all;
}

std::string Text(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void Say(Stream* stream, const std::string& text) {
  ASSERT_TRUE(stream->Write(std::as_bytes(std::span(text))));
}

Bytes Numbers(std::initializer_list<int> numbers) {
  Bytes bytes;
  for (const int n : numbers) bytes.push_back(static_cast<std::byte>(n));
  return bytes;
}

TEST(FakeUr, AnswersRtdeAsCaptured) {
  UrBench bench;
  const auto stream = bench.network.Connect({kUrHost, 30004}, 1);
  stream->Write(rtde::AskVersion());
  EXPECT_EQ(Heard(&bench, stream.get()), Numbers({0, 4, 'V', 1}));
  stream->Write(rtde::AskControllerVersion());
  const Bytes version = Heard(&bench, stream.get());
  ASSERT_EQ(version.size(), 0x13U);
  EXPECT_EQ(Bytes(version.begin(), version.begin() + 11),
            Numbers({0, 0x13, 'v', 0, 0, 0, 5, 0, 0, 0, 12}));
  const std::vector<rtde::Field> recipe = {
      {"timestamp", ""}, {"actual_q", ""}, {"actual_qd", ""}, {"runtime_state", ""}};
  stream->Write(rtde::AskOutputs(500, recipe));
  const Bytes types = Heard(&bench, stream.get());
  EXPECT_EQ(Text(types).substr(3), "\1DOUBLE,VECTOR6D,VECTOR6D,UINT32");
  stream->Write(rtde::AskStart());
  const Bytes data = Heard(&bench, stream.get());
  EXPECT_EQ(Bytes(data.begin(), data.begin() + 4), Numbers({0, 4, 'S', 1}));
  ASSERT_GE(data.size(), 8U);
  EXPECT_EQ(Bytes(data.begin() + 4, data.begin() + 8), Numbers({0, 0x70, 'U', 1}));
  EXPECT_EQ((data.size() - 4) % 0x70, 0U);
  stream->Write(rtde::AskPause());
  Heard(&bench, stream.get());
  EXPECT_TRUE(Heard(&bench, stream.get()).empty());
}

TEST(FakeUr, RecipesWithUnknownNamesAreInvalid) {
  UrBench bench;
  const auto stream = bench.network.Connect({kUrHost, 30004}, 1);
  const std::vector<rtde::Field> recipe = {{"timestamp", ""}, {"nonsense", ""}};
  stream->Write(rtde::AskOutputs(500, recipe));
  EXPECT_EQ(Text(Heard(&bench, stream.get())).substr(4), "DOUBLE,NOT_FOUND");
  stream->Write(rtde::AskStart());
  EXPECT_EQ(Heard(&bench, stream.get()).size(), 4U);  // no data
}

TEST(FakeUr, RateIsAsRequested) {
  UrBench bench;
  const auto stream = bench.network.Connect({kUrHost, 30004}, 1);
  const std::vector<rtde::Field> recipe = {{"timestamp", ""}};
  stream->Write(rtde::AskOutputs(125, recipe));
  stream->Write(rtde::AskStart());
  Heard(&bench, stream.get());
  EXPECT_EQ(Heard(&bench, stream.get(), 1).size(), 125 * 12U);
}

TEST(FakeUr, DashboardGreetsAndAnswersLines) {
  UrBench bench;
  const auto stream = bench.network.Connect({kUrHost, 29999}, 1);
  EXPECT_EQ(Text(Heard(&bench, stream.get())), "Connected: Universal Robots Dashboard Server\n");
  Say(stream.get(), "PolyscopeVersion\nis in rem");
  EXPECT_EQ(Text(Heard(&bench, stream.get())), "URSoftware 5.12.0.1101319 (Jan 01 2022)\n");
  Say(stream.get(), "ote control\n");
  EXPECT_EQ(Text(Heard(&bench, stream.get())), "true\n");
  Say(stream.get(), "sing\n");
  EXPECT_EQ(Text(Heard(&bench, stream.get())), "could not understand: 'sing'\n");
}

TEST(FakeUr, AcceptsAProgramInPieces) {
  UrBench bench;
  const auto stream = bench.network.Connect({kUrHost, 30003}, 1);
  const std::string program = "def hop():\n  while True:\n    sync()\n  end\nend\n";
  for (const char c : program) {
    EXPECT_FALSE(bench.fake.running());
    Say(stream.get(), std::string(1, c));
  }
  EXPECT_TRUE(bench.fake.running());
}

TEST(FakeUr, RefusesUnknownProgramsWithTheReason) {
  UrBench bench;
  const auto stream = bench.network.Connect({kUrHost, 30003}, 1);
  Say(stream.get(), "def hop():\n  movej([0,0,0,0,0,0])\nend\n");
  EXPECT_FALSE(bench.fake.running());
  EXPECT_EQ(bench.fake.log().back(), "program refused: line 2: unknown function 'movej'");
  Say(stream.get(), "def hop():\n  sync()\n  x = y\nend\n");
  bench.network.Pass(0.01);
  EXPECT_FALSE(bench.fake.running());
  EXPECT_EQ(bench.fake.log().back(), "program ended: line 3: unknown variable 'y'");
}

// In the protocol of ur_rtde's program, the command 9 moves the arm, 15 stops it and is
// acknowledged, and 255 ends the program.
TEST(FakeUr, ImplementsTheProgramOfUrRtde) {
  UrBench bench;
  const auto stream = bench.network.Connect({kUrHost, 30003}, 1);
  Say(stream.get(),
      "def rtde_control():\n  global reg_offset_int = # int register offset\n24\nend\n");
  ASSERT_TRUE(bench.fake.running());
  UrController& c = bench.fake.controller();
  bench.network.Pass(0.01);
  EXPECT_EQ(c.output_int[24], 1);
  c.input_double[25] = -0.2;
  c.input_double[30] = 2;
  c.input_int[24] = 9;
  bench.network.Pass(0.2);
  EXPECT_EQ(c.output_int[24], 1);
  EXPECT_DOUBLE_EQ(bench.mechanics.command[1], -0.2);
  c.input_double[24] = 4;
  c.input_int[24] = 15;
  bench.network.Pass(0.02);
  EXPECT_EQ(c.output_int[24], 1);  // still braking
  bench.network.Pass(0.1);
  EXPECT_EQ(c.output_int[24], 2);
  EXPECT_EQ(bench.mechanics.command[1], 0);
  c.input_int[24] = 0;
  bench.network.Pass(0.01);
  EXPECT_EQ(c.output_int[24], 1);
  c.input_int[24] = 77;
  bench.network.Pass(0.01);
  EXPECT_FALSE(bench.fake.running());
  EXPECT_EQ(bench.fake.log().back(), "program ended: ur_rtde's command 77 is not supported here");
}

}  // namespace
}  // namespace predictor
