// Numbers over time from files of other systems: tables, motion capture, robots' logs.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace predictor::tracks {

inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// The numbers of one channel.
struct Series {
  std::string name;
  std::string unit;                                  // as the file states it; "": it does not
  std::shared_ptr<const std::vector<double>> times;  // in the file's clock, ascending [s]
  std::vector<double> values;                        // one for each time; NaN: missing
};

struct SeriesFile {
  std::string name;                   // for messages
  std::vector<std::string> comments;  // lines that begin with #, without it
  std::vector<Series> series;
  std::vector<std::string> warnings;  // about doubtful content, as sentences

  // Returns null for an unknown channel.
  const Series* Find(const std::string& channel) const;
  // For an unknown channel, throws InputError that names the most similar one.
  const Series& At(const std::string& channel) const;
};

// How a table's time is read. Other formats state it.
struct TimeColumn {
  std::string name;  // "": the column called time or timestamp
  std::string unit;  // "": as the header states it, otherwise s
  double rate = 0;   // of the rows, of a table without times [Hz]; 0: it has times
};

// A larger file is refused [bytes].
inline constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 29U;

// Each throws InputError with the file and, in a text, the line, if the file is empty, damaged,
// foreign or too large, or if its clock goes back.
//
// A table with a header. Cells are separated by commas, semicolons or tabs. A cell of the header is
// "name" or "name [unit]". Missing numbers are empty or NaN. Columns of words are left out, and so
// are rows that repeat the time of the row before.
SeriesFile ReadCsv(const std::filesystem::path& file, const TimeColumn& time = {});
// Markers in the text format of OpenSim: channels NAME.x, NAME.y, NAME.z.
SeriesFile ReadTrc(const std::filesystem::path& file);
// Points and analog channels of the binary format of motion capture (https://www.c3d.org, read
// without processing): channels NAME.x, NAME.y, NAME.z; analog channels by their label. Time 0 is
// the first frame. Only the byte order of PCs is supported.
SeriesFile ReadC3d(const std::filesystem::path& file);
// By the name's ending: .csv, .tsv, .txt: table; .trc; .c3d; .mcap; .db3 (see ReadRosBag).
SeriesFile ReadSeries(const std::filesystem::path& file, const TimeColumn& time = {});

// The content of a file. Throws InputError if it cannot be read, or is empty or too large.
std::string ReadBytes(const std::filesystem::path& file);

// SI units of a unit's name: "mm" is 0.001. Throws InputError that lists the known names, with
// `what` as the place, if the name is not known or not of this kind.
double LengthFactor(const std::string& unit, const std::string& what);
double TimeFactor(const std::string& unit, const std::string& what);
double ForceFactor(const std::string& unit, const std::string& what);
double TorqueFactor(const std::string& unit, const std::string& what);

}  // namespace predictor::tracks
