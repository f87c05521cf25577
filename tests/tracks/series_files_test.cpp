// Tests tables, TRC files and C3D files, valid and invalid ones.
#include <cmath>
#include <cstring>

#include "tracks/files.h"
#include "tracks/series.h"

namespace predictor::tracks {
namespace {

class Csv : public Files {};
class Trc : public Files {};
class C3d : public Files {};

TEST_F(Csv, HasNamesUnitsAndMissingNumbers) {
  const SeriesFile file = ReadCsv(Write("a.csv",
                                        "# made up\n"
                                        "time [ms];head.p.x [mm];\"a; b\";note\n"
                                        "0;1.5;2;begins\n"
                                        "10;;nan;\n"
                                        "30;-2e3;4;ends\n"));
  ASSERT_EQ(file.series.size(), 2u);  // without the columns of time and words
  const Series& x = file.At("head.p.x");
  EXPECT_EQ(x.unit, "mm");
  EXPECT_EQ(*x.times, (std::vector<double>{0, 0.01, 0.03}));
  EXPECT_EQ(x.values[0], 1.5);
  EXPECT_TRUE(std::isnan(x.values[1]));
  EXPECT_EQ(x.values[2], -2000);
  EXPECT_EQ(file.At("a; b").values[2], 4);
  EXPECT_EQ(file.comments, std::vector<std::string>{" made up"});
}

TEST_F(Csv, OmitsAndReportsRepeatedTimes) {
  const SeriesFile file = ReadCsv(Write("a.csv", "time,x\n0,1\n0,2\n1,3\n"));
  EXPECT_EQ(file.At("x").values, (std::vector<double>{1, 3}));
  ASSERT_EQ(file.warnings.size(), 1u);
  ExpectWords(file.warnings[0], {"1 rows repeat"});
}

TEST_F(Csv, WithoutTimesHasTheGivenRate) {
  const SeriesFile file = ReadCsv(Write("a.csv", "x,y\n1,2\n3,4\n5,6\n"), {"", "", 200});
  EXPECT_EQ(*file.At("x").times, (std::vector<double>{0, 0.005, 0.01}));
  EXPECT_EQ(file.At("y").values, (std::vector<double>{2, 4, 6}));
}

// The ground truth of EuRoC has its names in a comment.
TEST_F(Csv, TakesNamesFromAComment) {
  const SeriesFile file = ReadCsv(Write("a.csv",
                                        "# a remark\n#timestamp, p_x [m], q_w []\n"
                                        "1403715524907143168,0.5,1\n1403715524912143104,0.6,1\n"),
                                  {"", "ns"});
  ASSERT_EQ(file.series.size(), 2u);
  EXPECT_EQ(file.At("p_x").unit, "m");
  EXPECT_EQ(file.At("q_w").unit, "");
  EXPECT_EQ(file.At("p_x").values, (std::vector<double>{0.5, 0.6}));
  EXPECT_NEAR((*file.At("p_x").times)[1] - 1403715524.912143104, 0, 1e-6);
  EXPECT_EQ(file.comments, (std::vector<std::string>{" a remark"}));
  ExpectWords(ErrorOf([&] { ReadCsv(Write("b.csv", "# remark\n0,1,2\n1,2,3\n")); }),
              {"b.csv:2", "only numbers", "names the columns"});
}

TEST_F(Csv, NamesTheLineAndTheRemedyOfAProblem) {
  const auto error = [&](const std::string& text, const TimeColumn& time = {}) {
    return ErrorOf([&] { ReadCsv(Write("bad.csv", text), time); });
  };
  ExpectWords(error(""), {"bad.csv", "empty"});
  ExpectWords(error("time,x\n0,1\n2,1\n1,1\n"), {"bad.csv:4", "goes back from 2 to 1 s"});
  ExpectWords(error("time,x\n0,1\n1,1,1\n"), {"bad.csv:3", "3 cells", "2"});
  ExpectWords(error("time,x\n0,1\n1,2..3\n"), {"bad.csv:3", "\"x\"", "2..3"});
  ExpectWords(error("time,x\n0,1\nlater,2\n"), {"bad.csv:3", "later"});
  ExpectWords(error("t,x\n0,1\n1,1\n"), {"No column is called time", "mapping"});
  ExpectWords(error("t,x\n0,1\n1,1\n", {"tt", "", 0}), {"tt"});
  ExpectWords(error("time [h],x\n0,1\n1,1\n"), {"\"h\"", "unit of time", "ms"});
  ExpectWords(error("time,x\n0,1\n"), {"1 rows"});
  ExpectWords(error("\x89MCAP0 binary"), {"1 columns"});
  ExpectWords(ErrorOf([] { ReadCsv("/nowhere.csv"); }), {"/nowhere.csv", "cannot be read"});
  ExpectWords(ErrorOf([&] { ReadCsv(Write("a.csv", "time,head\n0,1\n1,1\n")).At("haed"); }),
              {"haed", "Did you mean head?"});
}

const char* const kTrcHead =
    "PathFileType\t4\t(X/Y/Z)\ta.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
    "OrigNumFrames\n"
    "100\t100\t3\t2\tmm\t100\t1\t3\n"
    "Frame#\tTime\tLFHD\t\t\tRFHD\t\t\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n";

TEST_F(Trc, HasMarkersWithGaps) {
  const SeriesFile file = ReadTrc(Write(
      "a.trc", std::string(kTrcHead) +
                   "1\t0.00000\t1\t2\t3\t4\t5\t6\n2\t0.01000\t\t\t\t4\t5\t7\n3\t0.02000\t1\t2\t4"));
  EXPECT_EQ(file.series.size(), 6u);
  EXPECT_EQ(file.At("LFHD.z").values[2], 4);
  EXPECT_TRUE(std::isnan(file.At("LFHD.x").values[1]));
  EXPECT_TRUE(std::isnan(file.At("RFHD.z").values[2]));
  EXPECT_EQ(file.At("RFHD.z").unit, "mm");
}

TEST_F(Trc, SeesAClockThatJumps) {
  const auto error = [&](const std::string& rows) {
    return ErrorOf([&] { ReadTrc(Write("bad.trc", rows)); });
  };
  const std::string head = kTrcHead;
  ExpectWords(error(head + "1\t0\t1\t2\t3\t4\t5\t6\n2\t3.01\t1\t2\t3\t4\t5\t6\n"),
              {"bad.trc:8", "jumps by 3.01 s"});
  ExpectWords(error(head + "1\t0\t1\t2\t3\t4\t5\t6\n1\t0\t1\t2\t3\t4\t5\t6\n"), {"goes back"});
  // Frames that are missing must not count as a jump.
  EXPECT_EQ(error(head + "1\t0\t1\t2\t3\t4\t5\t6\n301\t3.0\t1\t2\t3\t4\t5\t6\n"), "no error");
  ExpectWords(error("time,x\n0,1\n"), {"not a TRC"});
  ExpectWords(error(head.substr(0, 60)), {"bad.trc"});
  std::string foot = head;
  foot.replace(foot.find("\tmm\t"), 4, "\tft\t");
  ExpectWords(error(foot), {"\"ft\"", "unit of length"});
}

// ---- C3D --------------------------------------------------------------------------------------

// Returns a parameter or group as it is stored. `link` is the offset to the next parameter or
// group.
std::string Entry(int id, const std::string& name, const std::string& content) {
  std::string entry;
  entry += static_cast<char>(name.size());
  entry += static_cast<char>(id);
  entry += name;
  const auto link = static_cast<std::uint16_t>(2 + content.size() + 1);
  entry.append(reinterpret_cast<const char*>(&link), 2);
  return entry + content + '\0';  // the description is empty
}
template <class T>
std::string Raw(T x) {
  return {reinterpret_cast<const char*>(&x), sizeof x};
}
std::string WholeNumber(std::int16_t x) { return std::string("\2\0", 2) + Raw(x); }
std::string Real(float x) { return std::string("\4\0", 2) + Raw(x); }
std::string Words(std::initializer_list<const char*> words) {
  std::string text = {-1, 2, 8, static_cast<char>(words.size())};
  for (std::string word : words) text += word.append(8 - word.size(), ' ');
  return text;
}

// Returns three frames with two points at 50 Hz and one analog channel at 100 Hz.
std::string MadeC3d(bool real_numbers) {
  std::string header(512, '\0');
  header[0] = 2;
  header[1] = 0x50;
  const auto put = [&](std::size_t word, std::uint16_t x) {
    std::memcpy(&header[2 * word], &x, 2);
  };
  put(1, 2);
  put(2, 2);  // analog values per frame
  put(3, 1);
  put(4, 3);
  const float scale = real_numbers ? -1 : 0.5F;
  std::string parameters = std::string("\1\x50\1\x54", 4) + Entry(-1, "POINT", "") +
                           Entry(1, "USED", WholeNumber(2)) + Entry(1, "SCALE", Real(scale)) +
                           Entry(1, "RATE", Real(50)) + Entry(1, "DATA_START", WholeNumber(3)) +
                           Entry(1, "LABELS", Words({"HEAD", "ELBOW"})) +
                           Entry(1, "UNITS", Words({"mm"})) + Entry(-2, "ANALOG", "") +
                           Entry(2, "USED", WholeNumber(1)) + Entry(2, "RATE", Real(100)) +
                           Entry(2, "LABELS", Words({"EMG1"})) + Entry(2, "UNITS", Words({"mV"})) +
                           Entry(2, "SCALE", Real(2)) + Entry(2, "OFFSET", WholeNumber(10)) +
                           Entry(2, "GEN_SCALE", Real(0.25F));
  parameters.resize(512, '\0');
  std::string data;
  const auto number = [&](int x) {
    data += real_numbers ? Raw(static_cast<float>(x)) : Raw(static_cast<std::int16_t>(x));
  };
  for (int frame = 0; frame < 3; ++frame) {
    for (const int x : {100, 200, 300 + frame, 0}) number(x);
    for (const int x : {1, 2, 3, frame == 1 ? -1 : 0}) number(x);
    for (const int x : {10 + frame, 14}) number(x);
  }
  return header + parameters + data;
}

TEST_F(C3d, HasPointsAndAnalogChannels) {
  for (const bool real_numbers : {false, true}) {
    const double scale = real_numbers ? 1 : 0.5;
    const SeriesFile file = ReadC3d(Write("a.c3d", MadeC3d(real_numbers)));
    EXPECT_EQ(file.series.size(), 7u);
    const Series& z = file.At("HEAD.z");
    EXPECT_EQ(z.unit, "mm");
    EXPECT_EQ(*z.times, (std::vector<double>{0, 0.02, 0.04}));
    EXPECT_EQ(z.values, (std::vector<double>{300 * scale, 301 * scale, 302 * scale}));
    EXPECT_TRUE(std::isnan(file.At("ELBOW.x").values[1]));
    EXPECT_EQ(file.At("ELBOW.y").values[2], 2 * scale);
    const Series& emg = file.At("EMG1");
    EXPECT_EQ(emg.times->size(), 6u);
    EXPECT_DOUBLE_EQ((*emg.times)[1], 0.01);
    // The values are (raw - offset) · scale · general scale.
    EXPECT_EQ(emg.values, (std::vector<double>{0, 2, 0.5, 2, 1, 2}));
    EXPECT_EQ(emg.unit, "mV");
  }
}

TEST_F(C3d, OfEveryShorterLengthIsRefused) {
  const std::string whole = MadeC3d(true);
  for (std::size_t n = 0; n < whole.size(); n += n < 1024 ? 7 : 1) {
    const std::string file = Write("cut.c3d", whole.substr(0, n));
    ExpectWords(ErrorOf([&] { ReadC3d(file); }), {"cut.c3d"});
  }
}

// A damaged byte must not crash the reader or cause it to allocate much memory. The reader must
// return numbers or state why it cannot read the file.
TEST_F(C3d, WithADamagedByteIsReadOrRefused) {
  const std::string whole = MadeC3d(false);
  int refused = 0;
  for (std::size_t i = 0; i < 1024; i += i < 16 ? 1 : i < 512 ? 20 : 3)
    for (const char value : {'\0', '\x7f', '\xff'}) {
      std::string bytes = whole;
      bytes[i] = value;
      const std::string file = Write("damaged.c3d", bytes);
      if (ErrorOf([&] { ReadC3d(file); }) != "no error") ++refused;
    }
  EXPECT_GT(refused, 50);
}

TEST_F(C3d, OfAnotherKindIsRefusedWithTheRemedy) {
  ExpectWords(ErrorOf([&] { ReadC3d(Write("a.c3d", std::string(2000, 'x'))); }), {"not a C3D"});
  std::string vax = MadeC3d(true);
  vax[512 + 3] = 85;
  ExpectWords(ErrorOf([&] { ReadC3d(Write("a.c3d", vax)); }),
              {"byte order", "Save the file again"});
  ExpectWords(ErrorOf([&] { ReadSeries(Write("a.xlsx", "x")); }), {".csv"});
}

TEST(Units, AreFactorsToSi) {
  EXPECT_EQ(LengthFactor("mm", ""), 0.001);
  EXPECT_EQ(TorqueFactor("N mm", ""), 0.001);
  ExpectWords(ErrorOf([] { LengthFactor("N", "head.x"); }), {"head.x", "\"N\"", "length", "mm"});
}

}  // namespace
}  // namespace predictor::tracks
