#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "progress.h"
#include "recording/columns.h"
#include "recording/reader.h"

namespace predictor {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

File Open(const std::string& name) {
  if (name.empty() || name == "-") return {stdout, std::fflush};
  std::FILE* file = std::fopen(name.c_str(), "w");
  if (!file)
    throw InputError(name,
                     std::string("The file cannot be written: ") + std::strerror(errno) + ".");
  return {file, std::fclose};
}

void List(const std::vector<Column>& columns) {
  std::string text;
  for (const Column& column : columns)
    text += column.name + (column.unit.empty() ? "" : "  [" + column.unit + "]") + "\n";
  WriteOut(text);
}

std::string Heading(const std::vector<Column>& columns) {
  std::string line;
  for (const Column& column : columns)
    line += (line.empty() ? "" : ",") + column.name +
            (column.unit.empty() ? "" : " [" + column.unit + "]");
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

// Columns that the patterns ask for; those of inputs if one of them does so by name.
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

// False at the end, and at damage, which is then told.
bool NextOrDamage(RecordingReader* reader, TickRecord* record, std::string* damage) {
  try {
    return reader->Next(record);
  } catch (const InputError& error) {
    *damage = error.what();
    return false;
  }
}

// Of a recording that was cut only reading all of it tells, which may end at damage.
double CountOrNothing(RecordingReader* reader) {
  try {
    return static_cast<double>(reader->count());
  } catch (const InputError&) {
    return 0;
  }
}

// As CSV has it: in quotes, those inside doubled.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string EventRow(const RecordingEvent& event, std::uint64_t first, double dt) {
  const double time = dt * (static_cast<double>(event.tick) - static_cast<double>(first));
  const std::string text = event.text.empty() && event.lost > 0
                               ? std::to_string(event.lost) + " ticks before this one are missing"
                               : event.text;
  return std::to_string(event.tick) + "," + Formatted("%.9g", time) + "," + event.kind + "," +
         Quoted(text) + "\n";
}

// What happened. Time is that since the recording's first tick.
int ExportEvents(const ExportDataOptions& options, std::uint64_t first, RecordingReader* reader) {
  std::string text = "tick,time [s],kind,text\n";
  for (const RecordingEvent& event : reader->events())
    text += EventRow(event, first, reader->header().dt);
  const File out = Open(options.output);
  if (std::fputs(text.c_str(), out.get()) < 0 || std::fflush(out.get()) != 0)
    throw InputError(options.output, "The file could not be written. Is there room on the disk?");
  if (reader->more_events() > 0)
    std::fprintf(stderr, "%llu more events are in the file than can be read.\n",
                 static_cast<unsigned long long>(reader->more_events()));
  return kFinished;
}

}  // namespace

int ExportDataCommand(const ExportDataOptions& options) {
  RecordingReader reader(options.recording);
  TellProblem(reader.problem());
  TickRecord record;
  if (!reader.Next(&record))
    throw InputError(options.recording, "The recording holds no tick; there is nothing to export.");
  if (options.events) return ExportEvents(options, record.tick, &reader);
  if (options.list) {
    List(ColumnsOf(record, InputColumns::kIncluded));
    return kFinished;
  }
  const std::vector<Column> columns = Chosen(options.channels, record);
  const File out = Open(options.output);
  Progress progress("Exporting", CountOrNothing(&reader), options.quiet);
  std::string text = Heading(columns);
  std::string damage;  // at which it ends
  std::uint64_t ticks = 0;
  bool good = true;
  for (bool more = true; more && good; more = NextOrDamage(&reader, &record, &damage)) {
    if (ticks++ % options.every == 0) text += Row(columns, record);
    if (text.size() < 1U << 16U) continue;
    good = std::fputs(text.c_str(), out.get()) >= 0;
    text.clear();
    progress.Update(static_cast<double>(ticks));
  }
  good = good && std::fputs(text.c_str(), out.get()) >= 0 && std::fflush(out.get()) == 0;
  progress.Finish();
  if (!good)
    throw InputError(options.output, "The file could not be written. Is there room on the disk?");
  if (!damage.empty())
    throw InputError(damage + " The table ends before it, with tick " +
                     std::to_string(record.tick) + ": what comes behind the damage is not in it.");
  return kFinished;
}

}  // namespace predictor
