#include <array>
#include <condition_variable>
#include <ctime>
#include <deque>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "commands.h"
#include "core/error.h"
#include "progress.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "report/report.h"
#include "report/run_names.h"

namespace predictor {
namespace {

constexpr std::size_t kMaxRecordings = 8;  // the number of available colours
// Total time of all recordings for which every tick is kept [s], so that the page stays below 20
// MB.
constexpr double kDetail = 120;

std::string Date(std::int64_t unix_ns) {
  if (unix_ns <= 0) return "";
  const std::time_t seconds = unix_ns / 1'000'000'000;
  std::tm local{};
  char text[64];
  if (!localtime_r(&seconds, &local) ||
      std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local) == 0)
    return "";
  return text;
}

RunInfo Describe(const std::string& file, RecordingReader* reader) {
  const RecordingHeader& header = reader->header();
  RunInfo info;
  info.name = std::filesystem::path(file).filename().string();
  info.scenario = RecordedScenario(header, file, ".");
  info.scenario_yaml = header.scenario_yaml;
  info.program_version = header.program_version;
  info.labels = header.labels;
  info.loop = header.loop;
  info.date = Date(header.start_unix_ns);
  info.problem = reader->problem();
  for (const RecordingEvent& event : reader->events())
    // The report derives the other events from the ticks.
    if (event.kind == "marker" || event.kind == "event")
      info.events.push_back({event.tick, event.text});
  if (reader->more_events() > 0)
    info.problem +=
        (info.problem.empty() ? "" : " ") + std::to_string(reader->more_events()) +
        " of the recording's events are omitted: it has more than the program can read.";
  return info;
}

// Reads in a separate thread: unpacking and checking take twice as long as the evaluation.
class ReadAhead {
 public:
  explicit ReadAhead(RecordingReader* reader) : reader_(reader), thread_([this] { Run(); }) {}
  ~ReadAhead() {
    {
      const std::lock_guard lock(mutex_);
      abandoned_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  // The next records, in order; empty at the end. They are valid until the next call. Rethrows
  // exceptions of the reading thread.
  std::span<const TickRecord> Next() {
    std::unique_lock lock(mutex_);
    if (taken_) free_.push_back(std::move(taken_));
    changed_.notify_all();
    changed_.wait(lock, [this] { return !ready_.empty() || ended_; });
    if (ready_.empty()) {
      if (error_) std::rethrow_exception(error_);
      return {};
    }
    taken_ = std::move(ready_.front());
    ready_.pop_front();
    return {taken_->records.data(), taken_->count};
  }

 private:
  static constexpr std::size_t kBatches = 4;
  struct Batch {
    std::array<TickRecord, 256> records;
    std::size_t count = 0;
  };

  void Run() {
    try {
      for (std::unique_ptr<Batch> batch = Free(); batch; batch = Free()) {
        batch->count = 0;
        while (batch->count < batch->records.size() && reader_->Next(&batch->records[batch->count]))
          ++batch->count;
        if (batch->count == 0) break;
        const std::lock_guard lock(mutex_);
        ready_.push_back(std::move(batch));
        changed_.notify_all();
      }
    } catch (...) {
      error_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  // Null if the reader was abandoned.
  std::unique_ptr<Batch> Free() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !free_.empty() || made_ < kBatches || abandoned_; });
    if (abandoned_) return nullptr;
    if (free_.empty()) {
      ++made_;
      return std::make_unique<Batch>();
    }
    std::unique_ptr<Batch> batch = std::move(free_.back());
    free_.pop_back();
    return batch;
  }

  RecordingReader* reader_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::unique_ptr<Batch>> ready_;
  std::vector<std::unique_ptr<Batch>> free_;
  std::unique_ptr<Batch> taken_;
  std::size_t made_ = 0;
  bool ended_ = false, abandoned_ = false;
  std::exception_ptr error_;
  std::thread thread_;  // last, because it uses all other members
};

RunData Read(const std::string& file, double detail, bool quiet) {
  RecordingReader reader(file);
  RunInfo info = Describe(file, &reader);
  Progress progress("Reading", static_cast<double>(reader.count()), quiet);
  RunCollector collector(std::move(info), {.detail = detail});
  std::uint64_t done = 0;
  ReadAhead ahead(&reader);
  for (std::span<const TickRecord> batch = ahead.Next(); !batch.empty(); batch = ahead.Next()) {
    for (const TickRecord& record : batch) collector.Add(record);
    done += batch.size();
    progress.Update(static_cast<double>(done));
  }
  RunData run = collector.Finish();
  progress.Finish();
  if (run.records == 0)
    throw InputError(file, "The recording has no ticks, so there is nothing to report.");
  return run;
}

// Names several runs by the values that differ between them.
void NameRuns(const std::vector<std::string>& files, std::vector<RunData>* runs) {
  if (runs->size() < 2) return;
  std::vector<NamedRun> named;
  for (std::size_t k = 0; k < runs->size(); ++k) {
    const auto& labels = (*runs)[k].info.labels;
    const auto condition = labels.find("condition");
    named.push_back({files[k], condition == labels.end() ? "" : condition->second});
  }
  const std::vector<std::string> names = ShortNames(named);
  for (std::size_t k = 0; k < runs->size(); ++k) {
    (*runs)[k].info.name = names[k];
    (*runs)[k].info.file = files[k];
  }
}

void WriteFile(const std::string& name, const std::string& text) {
  std::ofstream out(name, std::ios::binary);
  out << text;
  if (!out.flush()) throw InputError(name, "The file could not be written.");
}

}  // namespace

int ReportCommand(const ReportOptions& options) {
  if (options.recordings.size() > kMaxRecordings)
    throw InputError("At most " + std::to_string(kMaxRecordings) +
                     " recordings can be compared in one page.");
  std::string output = options.output;
  if (output.empty())
    output = options.recordings.size() == 1
                 ? std::filesystem::path(options.recordings[0]).replace_extension(".html").string()
                 : "comparison.html";
  options.CheckWritable();
  options.RefuseToReplace(output);
  std::vector<RunData> runs;
  for (const std::string& file : options.recordings)
    runs.push_back(
        Read(file, kDetail / static_cast<double>(options.recordings.size()), options.quiet));
  NameRuns(options.recordings, &runs);
  const ReportDocument report = MakeReport(runs, PREDICTOR_VERSION);
  WriteFile(output, report.html);
  const nlohmann::json result = {{"page", output}, {"recordings", options.recordings}};
  options.Write("Wrote " + output + ". Open it in a browser.\n", result.dump(2) + "\n");
  return kFinished;
}

}  // namespace predictor
