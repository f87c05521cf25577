#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "progress.h"
#include "recording/columns.h"
#include "recording/reader.h"
#include "restored_scenario.h"
#include "screen.h"

namespace predictor {
namespace {

// A table that is written in pieces to a file or, if the name is empty, to standard output.
class Table {
 public:
  // Throws InputError if the file cannot be written.
  explicit Table(const std::string& name) : name_(name == "-" ? "" : name), file_(Open(name_)) {}
  // Control characters are removed for a terminal, because texts in a recording come from an
  // unknown source.
  bool Add(const std::string& text) {
    const bool shown = name_.empty() && isatty(STDOUT_FILENO) == 1;
    return std::fputs((shown ? Printable(text, Lines::kMany) : text).c_str(), file_.get()) >= 0;
  }
  // Throws InputError unless everything was written.
  void Finish(bool good) {
    if (!good || std::fflush(file_.get()) != 0)
      throw InputError(name_, "The file could not be written. Check the free space on the disk.");
  }

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  static File Open(const std::string& name) {
    if (name.empty()) return {stdout, std::fflush};
    std::FILE* file = std::fopen(name.c_str(), "w");
    if (!file)
      throw InputError(name,
                       std::string("The file could not be written: ") + std::strerror(errno) + ".");
    return {file, std::fclose};
  }

  std::string name_;
  File file_;
};

// Returns the reader's first record. Throws InputError if the recording is empty.
TickRecord FirstRecord(const RecordingOptions& options, RecordingReader* reader) {
  ShowProblem(reader->problem());
  TickRecord record;
  if (!reader->Next(&record))
    throw InputError(options.recording,
                     "The recording has no ticks, so there is nothing to export.");
  return record;
}

std::string Heading(const std::vector<Column>& columns) {
  std::string line;
  for (const Column& column : columns)
    line += (line.empty() ? "" : ",") +
            CsvCell(column.name + (column.unit.empty() ? "" : " [" + column.unit + "]"));
  return line + "\n";
}

std::string Row(const std::vector<Column>& columns, const TickRecord& record) {
  std::string line;
  for (const Column& column : columns) {
    if (!line.empty()) line += ',';
    line += column.Text(record);
  }
  return line + "\n";
}

// Replaces the units "rad or m" by those of the recorded cobot's joints, if its model is known.
void FindUnits(const RecordingHeader& header, std::vector<Column>* columns) {
  SetJointUnits(RestoredScenario(header).PrismaticJoints(), columns);
}

nlohmann::ordered_json JsonOf(const Column& column) {
  return {{"name", column.name},
          {"type", column.type},
          {"unit", column.unit},
          {"frame", column.frame},
          {"meaning", column.meaning}};
}

// Returns the columns that match the patterns. Columns of inputs are included only if a pattern
// names them explicitly.
std::vector<Column> Chosen(const std::vector<std::string>& channels, const TickRecord& record) {
  if (channels.empty()) return ColumnsOf(record);
  const bool inputs = std::any_of(channels.begin(), channels.end(), [](const std::string& pattern) {
    return pattern.starts_with("inputs");
  });
  std::vector<std::string> patterns = {"run.tick", "run.run_time"};
  patterns.insert(patterns.end(), channels.begin(), channels.end());
  return Select(ColumnsOf(record, inputs ? InputColumns::kIncluded : InputColumns::kLeftOut),
                patterns);
}

// Returns false at the end of the recording and at a damaged part, which `damage` then describes.
bool NextOrDamage(RecordingReader* reader, TickRecord* record, std::string* damage) {
  try {
    return reader->Next(record);
  } catch (const InputError& error) {
    *damage = error.what();
    return false;
  }
}

// To count the ticks of a truncated recording, the program must read the whole file, and reading
// fails at damaged parts.
double CountOrNothing(RecordingReader* reader) {
  try {
    return static_cast<double>(reader->count());
  } catch (const InputError&) {
    return 0;
  }
}

struct EventRow {
  std::uint64_t tick;
  double time;  // since the recording's first tick [s]
  std::string kind, text;
};

EventRow RowOf(const RecordingEvent& event, std::uint64_t first, double dt) {
  const double time = dt * (static_cast<double>(event.tick) - static_cast<double>(first));
  const std::string text = event.text.empty() && event.lost > 0
                               ? std::to_string(event.lost) + " ticks before this tick are missing"
                               : event.text;
  return {event.tick, time, event.kind, text};
}

}  // namespace

int ListChannelsCommand(const RecordingOptions& options) {
  options.CheckWritable();
  RecordingReader reader(options.recording);
  std::string text;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::vector<Column> columns = ColumnsOf(FirstRecord(options, &reader), InputColumns::kIncluded);
  FindUnits(reader.header(), &columns);
  for (const Column& column : columns) {
    text += column.name + (column.unit.empty() ? "" : "  [" + column.unit + "]") +
            (column.frame.empty() ? "" : "  in " + column.frame) +
            (column.meaning.empty() ? "" : "  # " + column.meaning) + "\n";
    list.push_back(JsonOf(column));
  }
  options.Write(text, list.dump(2) + "\n");
  return kFinished;
}

std::string QuantitiesReference() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Column& column : AllColumns()) list.push_back(JsonOf(column));
  return list.dump(2) + "\n";
}

int ExportEventsCommand(const RecordingOptions& options) {
  options.CheckWritable();
  RecordingReader reader(options.recording);
  const std::uint64_t first = FirstRecord(options, &reader).tick;
  options.RefuseToReplace(options.output);
  std::string text = "tick,time [s],kind,text\n";
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const RecordingEvent& event : reader.events()) {
    const EventRow row = RowOf(event, first, reader.header().dt);
    text += std::to_string(row.tick) + "," + Formatted("%.9g", row.time) + "," + CsvCell(row.kind) +
            "," + CsvCell(row.text) + "\n";
    list.push_back(
        {{"tick", row.tick}, {"time_s", row.time}, {"kind", row.kind}, {"text", row.text}});
  }
  options.WriteJson(list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  if (options.json != "-" || !options.output.empty()) {
    Table out(options.output);
    out.Finish(out.Add(text));
  }
  if (reader.more_events() > 0)
    TheScreen().Print(
        Formatted("%llu events are missing, because the file has more events than the program "
                  "can read.",
                  static_cast<unsigned long long>(reader.more_events())));
  return kFinished;
}

int ExportDataCommand(const RecordingOptions& options) {
  options.CheckWritable();
  if (options.json == "-" && (options.output.empty() || options.output == "-"))
    throw InputError(
        "The table and the JSON cannot both go to standard output. Give a file for the table with "
        "-o, or for the JSON with --json FILE.");
  RecordingReader reader(options.recording);
  TickRecord record = FirstRecord(options, &reader);
  std::vector<Column> columns = Chosen(options.channels, record);
  FindUnits(reader.header(), &columns);
  options.RefuseToReplace(options.output);
  Table out(options.output);
  Progress progress("Exporting", CountOrNothing(&reader), options.quiet);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Column& column : columns) list.push_back(JsonOf(column));
  std::string text = Heading(columns);
  std::string damage;  // damage at which the recording ends
  std::uint64_t ticks = 0, rows = 0;
  bool good = true;
  for (bool more = true; more && good; more = NextOrDamage(&reader, &record, &damage)) {
    if (ticks++ % options.every == 0) {
      text += Row(columns, record);
      ++rows;
    }
    if (text.size() < 1U << 16U) continue;
    good = out.Add(text);
    text.clear();
    progress.Update(static_cast<double>(ticks));
  }
  good = good && out.Add(text);
  progress.Finish();
  out.Finish(good);
  if (!damage.empty())
    throw InputError(
        damage + " The table ends at tick " + std::to_string(record.tick) +
        ". To get the rest, repair the file with `predictor repair` and export the result.");
  options.WriteJson(
      nlohmann::ordered_json{{"ticks", ticks}, {"rows", rows}, {"columns", std::move(list)}}.dump(
          2) +
      "\n");
  return kFinished;
}

}  // namespace predictor
