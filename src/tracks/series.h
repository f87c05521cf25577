// Reads numbers over time from files of other systems: tables, motion capture and robots' logs.
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
  std::string unit;                                  // as stated in the file; "": not stated
  std::shared_ptr<const std::vector<double>> times;  // in the file's clock, ascending [s]
  std::vector<double> values;                        // one for each time; NaN: missing
};

struct SeriesFile {
  std::string name;                   // name for messages
  std::vector<std::string> comments;  // comment lines, without their #
  std::vector<Series> series;
  std::vector<std::string> warnings;  // sentences about doubtful content

  // Returns null for an unknown channel.
  const Series* Find(const std::string& channel) const;
  // Throws InputError for an unknown channel and names the most similar one.
  const Series& At(const std::string& channel) const;
};

// The way in which the times of a table are read. Files of other formats define their time
// themselves.
struct TimeColumn {
  std::string name;  // "": the column called time or timestamp
  std::string unit;  // "": as the header states it, otherwise s
  double rate = 0;   // rows per second in a table without times; 0: the table has times
};

// Larger files are refused [bytes].
inline constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 29U;

// Each function throws InputError if the file is empty, damaged, of another format or too large, or
// if its times go back. The message names the file and, for a text file, the line.
//
// Reads a table with a header. Cells are separated by commas, semicolons or tabs. A cell of the
// header is "name" or "name [unit]". Missing numbers are empty or NaN. Columns of words are
// omitted. Rows with the same time as the previous row are also omitted.
SeriesFile ReadCsv(const std::filesystem::path& file, const TimeColumn& time = {});
// Reads markers in the text format of OpenSim, as channels NAME.x, NAME.y and NAME.z.
SeriesFile ReadTrc(const std::filesystem::path& file);
// Reads points and analog channels of the binary format of motion capture (https://www.c3d.org)
// without processing. Points become channels NAME.x, NAME.y and NAME.z, and analog channels have
// their label. Time 0 is the first frame. Only the byte order of PCs is supported.
SeriesFile ReadC3d(const std::filesystem::path& file);
// Chooses the reader by the ending of the file's name. The endings are .csv, .tsv or .txt for a
// table, and .trc, .c3d, .mcap and .db3 (see ReadRosBag).
SeriesFile ReadSeries(const std::filesystem::path& file, const TimeColumn& time = {});

// Returns the contents of a file. Throws InputError if the file cannot be read, is empty, or is too
// large.
std::string ReadBytes(const std::filesystem::path& file);

// Returns the factor to SI units for a unit's name, such as 0.001 for "mm". If the name is unknown
// or is not a unit of this kind, throws InputError. The message gives `what` as the place and lists
// the known names.
double LengthFactor(const std::string& unit, const std::string& what);
double TimeFactor(const std::string& unit, const std::string& what);
double ForceFactor(const std::string& unit, const std::string& what);
double TorqueFactor(const std::string& unit, const std::string& what);

}  // namespace predictor::tracks
