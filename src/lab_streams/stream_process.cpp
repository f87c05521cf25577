#include "lab_streams/stream_process.h"

#include <grp.h>
#include <malloc.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <future>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "lab_streams/lsl_library.h"
#include "process/attached_run.h"
#include "process/child.h"
#include "process/control_channel.h"
#include "scenario/yaml_tree.h"

namespace predictor::lab_streams {
namespace {

constexpr int kPause = 5;            // between two looks at the streams [ms]
constexpr int kPriority = 5;         // niceness: lower priority than the run
constexpr double kResolve = 5;       // time for which a stream is looked for [s]
constexpr double kSearch = 2;        // for each look for a stream that was lost [s]
constexpr double kOpen = 10;         // for the first contact with a stream [s]
constexpr double kList = 1;          // for a list of all streams, for a message [s]
constexpr int kBuffer = 4;           // of an inlet [s], or in 100 samples
constexpr std::size_t kChunk = 256;  // samples that are taken at once
constexpr auto kOffsetPeriod = std::chrono::seconds(1);

std::uint64_t Monotonic() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

// Returns the monotonic clock minus LSL's clock [s], from the closest of several pairs of readings.
double ClockDifference(const LslLibrary& lsl) {
  double best = 1e9, difference = 0;
  for (int i = 0; i < 20; ++i) {
    const double before = 1e-9 * static_cast<double>(Monotonic());
    const double there = lsl.local_clock();
    const double after = 1e-9 * static_cast<double>(Monotonic());
    if (after - before >= best) continue;
    best = after - before;
    difference = (before + after) / 2 - there;
  }
  return difference;
}

std::string NamesOfAll(const LslLibrary& lsl) {
  std::array<LslInfo, 16> infos{};
  const int count = lsl.resolve_all(infos.data(), infos.size(), kList);
  std::vector<std::string> names;
  for (int i = 0; i < std::max(count, 0); ++i) {
    const LslInfo info = infos[static_cast<std::size_t>(i)];
    names.push_back(Quote(lsl.get_name(info)) + " (type " + Quote(lsl.get_type(info)) + ")");
    lsl.destroy_streaminfo(info);
  }
  return names.empty() ? "There are no streams in the network."
                       : "The network has the streams " + Join(names) + ".";
}

// Finds the stream with this name or, if there is none, with this type.
LslInfo Find(const LslLibrary& lsl, const std::string& name) {
  std::array<LslInfo, 8> infos{};
  int count = 0;
  for (const char* property : {"name", "type"}) {
    count = lsl.resolve_byprop(infos.data(), infos.size(), property, name.c_str(), 1, kResolve);
    if (count > 0) break;
  }
  if (count < 1)
    throw InputError("No stream of the Lab Streaming Layer has the name or type " + Quote(name) +
                     ". " + NamesOfAll(lsl) + " Start the sender first.");
  for (int i = 1; i < count; ++i) lsl.destroy_streaminfo(infos[static_cast<std::size_t>(i)]);
  if (count > 1)
    throw InputError(std::to_string(count) + " streams of the Lab Streaming Layer match " +
                     Quote(name) + ". Give the name of one of them.");
  return infos[0];
}

bool IsThere(const LslLibrary& lsl, const std::string& name) {
  for (const char* property : {"name", "type"}) {
    LslInfo info = nullptr;
    if (lsl.resolve_byprop(&info, 1, property, name.c_str(), 1, kSearch) < 1) continue;
    lsl.destroy_streaminfo(info);
    return true;
  }
  return false;
}

class Inlet {
 public:
  Inlet(const LslLibrary& lsl, const Json& wanted, std::uint32_t index)
      : lsl_(lsl), index_(index), name_(wanted["stream"]) {
    const LslInfo found = Find(lsl, name_);
    inlet_ = lsl.create_inlet(found, kBuffer, 0, 1);
    lsl.destroy_streaminfo(found);
    std::int32_t error = kLslNoError;
    const LslInfo info = inlet_ ? lsl.get_fullinfo(inlet_, kOpen, &error) : nullptr;
    if (info == nullptr || error != kLslNoError) Fail("does not respond");
    Describe(info, wanted["map"]);
    lsl.destroy_streaminfo(info);
    lsl.set_postprocessing(inlet_, kLslClockSync | kLslMonotonize);
    offset_ = lsl.time_correction(inlet_, kOpen, &error);
    if (error == kLslNoError) lsl.open_stream(inlet_, kOpen, &error);
    if (error != kLslNoError) Fail("cannot be opened");
  }

  const tracks::StreamDescription& description() const { return description_; }
  const std::string& name() const { return name_; }  // name or type by which it was found
  bool lost() const { return lost_; }                // liblsl does not look for it again

  // Publishes the samples that arrived. `difference` is that of ClockDifference.
  void Take(double difference, StreamRing* ring) {
    const std::size_t channels = description_.channels.size();
    values_.resize(kChunk * channels);
    std::array<double, kChunk> times{};
    std::int32_t error = kLslNoError;
    const unsigned long count = lsl_.pull_chunk_d(inlet_, values_.data(), times.data(),
                                                  values_.size(), times.size(), 0, &error);
    // liblsl itself connects again to a stream whose sender has a source_id.
    if (error == kLslLost && !std::exchange(lost_, true))
      SendLine(kControlDescriptor,
               {{"say", "The stream " + Quote(name_) +
                            " was lost. Nothing is measured by it until it is back."}},
               false);
    if (error != kLslNoError || count > values_.size()) return;
    for (std::size_t i = 0; i < count / channels; ++i) {
      const double time = times[i] + difference;
      if (!(time > 0 && time < 1e9)) continue;
      StreamSample sample{.wall_ns = static_cast<std::uint64_t>(1e9 * time),
                          .stream = index_,
                          .count = static_cast<std::uint32_t>(channels),
                          .clock_offset = offset_};
      std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(i * channels), channels,
                  sample.values.begin());
      if (IsPlausible(sample)) ring->Publish(sample);
    }
  }

  // Asks for the present offset of the sender's clock, without waiting for it.
  void UpdateOffset() {
    std::int32_t error = kLslNoError;
    const double offset = lsl_.time_correction(inlet_, 0, &error);
    if (error == kLslNoError && std::isfinite(offset)) offset_ = offset;
  }

 private:
  [[noreturn]] void Fail(const char* what) const {
    throw InputError("The stream " + Quote(name_) + " " + what + ". Check its sender.");
  }

  void Describe(LslInfo info, const std::string& map) {
    const std::int32_t count = lsl_.get_channel_count(info);
    if (count < 1 || count > static_cast<std::int32_t>(kMaxStreamChannels))
      throw InputError("The stream " + Quote(name_) + " has " + std::to_string(count) +
                       " channels. At most " + std::to_string(kMaxStreamChannels) +
                       " are allowed.");
    if (lsl_.get_channel_format(info) == kLslString)
      throw InputError("The stream " + Quote(name_) + " has words, not numbers.");
    description_.name = Printable(lsl_.get_name(info));
    description_.map = map;
    description_.rate = lsl_.get_nominal_srate(info);
    if (!std::isfinite(description_.rate)) description_.rate = 0;
    LslXml channel = lsl_.child(lsl_.child(lsl_.get_desc(info), "channels"), "channel");
    for (std::int32_t i = 0; i < count; ++i) {
      const std::string label = Printable(lsl_.child_value_n(channel, "label"));
      description_.channels.push_back(label.empty() ? "channel" + std::to_string(i + 1) : label);
      description_.units.push_back(UnitOf(lsl_.child_value_n(channel, "unit")));
      channel = lsl_.next_sibling(channel);
    }
  }

  // Returns the short name of a unit that the metadata of LSL write out (XDF's wiki).
  static std::string UnitOf(const std::string& unit) {
    constexpr std::pair<const char*, const char*> kShort[] = {
        {"meters", "m"}, {"millimeters", "mm"}, {"centimeters", "cm"},
        {"volts", "V"},  {"millivolts", "mV"},  {"microvolts", "µV"}};
    for (const auto& [name, symbol] : kShort)
      if (unit == name) return symbol;
    return Printable(unit);
  }

  const LslLibrary& lsl_;
  std::uint32_t index_;
  std::string name_;
  LslInlet inlet_ = nullptr;
  tracks::StreamDescription description_;
  std::vector<double> values_;
  double offset_ = 0;  // of the sender's clock [s]
  bool lost_ = false;
};

// Looks for lost streams, while the other streams are received.
class SearchForLost {
 public:
  explicit SearchForLost(const LslLibrary& lsl) : lsl_(lsl) {}

  // Throws InputError when all lost streams are back, because the receiver must then be restarted.
  // An earlier restart would end the reception of the other streams until all are there.
  void Look(const std::vector<Inlet>& inlets) {
    if (found_.valid()) {
      if (found_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
      if (found_.get()) throw InputError("All streams that were lost are back.");
    }
    std::vector<std::string> names;
    for (const Inlet& inlet : inlets)
      if (inlet.lost()) names.push_back(inlet.name());
    if (names.empty()) return;
    found_ = std::async(std::launch::async, [this, names] {
      return std::ranges::all_of(names, [this](const auto& name) { return IsThere(lsl_, name); });
    });
  }

 private:
  const LslLibrary& lsl_;
  std::future<bool> found_;
};

// The recording and the evaluator keep the channels of the start of the run.
void RefuseOtherChannels(const Json& described, const std::vector<Inlet>& inlets) {
  for (std::size_t i = 0; i < inlets.size(); ++i) {
    const auto before = tracks::ParseStream(described.at(i).get<std::string>());
    const tracks::StreamDescription& now = inlets[i].description();
    if (before.channels != now.channels || before.units != now.units)
      throw InputError("The stream " + Quote(now.name) +
                       " has other channels than at the start of the run. Start the run again.");
  }
}

// Returns false if the run has ended. The end of the run closes the channel.
bool WaitAWhile() {
  pollfd run{kControlDescriptor, POLLIN, 0};
  return poll(&run, 1, kPause) == 0 || (run.revents & (POLLHUP | POLLERR | POLLIN)) == 0;
}

void Serve(const Json& start) {
  setpriority(PRIO_PROCESS, 0, kPriority);
  mallopt(M_ARENA_MAX, 2);  // each thread of liblsl would otherwise reserve its own address space
  const LslLibrary lsl(start["library"].get<std::string>());
  lsl.protocol_version();  // reads the configuration while all files can be read
  GiveUpRoot(start);
  Shared<StreamBoard> board(kMailboxDescriptor, true);
  std::vector<Inlet> inlets;
  Json texts = Json::array();
  for (const Json& wanted : start["streams"]) {
    inlets.emplace_back(lsl, wanted, static_cast<std::uint32_t>(inlets.size()));
    texts.push_back(TextOf(inlets.back().description()));
  }
  if (const auto described = start.find("described"); described != start.end())
    RefuseOtherChannels(*described, inlets);
  SearchForLost search(lsl);
  const double difference = ClockDifference(lsl);
  SendLine(kControlDescriptor, {{"ready", "receives"}, {"streams", texts}}, true);
  for (auto asked = std::chrono::steady_clock::now(); WaitAWhile();) {
    for (Inlet& inlet : inlets) inlet.Take(difference, &board->samples);
    if (std::chrono::steady_clock::now() - asked < kOffsetPeriod) continue;
    for (Inlet& inlet : inlets) inlet.UpdateOffset();
    search.Look(inlets);
    asked = std::chrono::steady_clock::now();
  }
  std::_Exit(0);  // the threads of liblsl need not end in order
}

Json StartLine(const StreamOptions& options) {
  if (options.streams.size() > kMaxStreams)
    throw InputError("--person-stream: at most " + std::to_string(kMaxStreams) +
                     " streams are allowed.");
  Json streams = Json::array();
  for (const std::string& stream : options.streams) {
    const std::filesystem::path file(stream);
    if (file.extension() != ".yaml" && file.extension() != ".yml") {
      streams.push_back({{"stream", stream}, {"map", ""}});
      continue;
    }
    const std::string text = ReadYamlText(file, "a mapping of a stream");
    streams.push_back({{"stream", tracks::ParseStreamMap(text, stream).stream}, {"map", text}});
  }
  // A relative name would depend on the working directory of the other process.
  return {{"streams", streams},
          {"library",
           options.library.empty() ? "" : std::filesystem::absolute(options.library).string()}};
}

}  // namespace

StreamProcess::StreamProcess(const StreamOptions& options, const Shared<StreamBoard>& board,
                             Notify show) {
  Json first;
  process_ = std::make_unique<SupervisedProcess>(
      ChildSetup{.name = "The receiver of streams",
                 .subcommand = kStreamSubcommand,
                 .start = StartLine(options),
                 .mailbox = board.descriptor(),
                 .notify = std::move(show),
                 .hear =
                     [&first, heard = false](const Json& line) mutable {
                       // Later lines come from a restarted process, when `first` is gone.
                       if (std::exchange(heard, true)) return;
                       first = line;
                     },
                 .without = "the run continues, and nothing is measured by streams meanwhile"});
  const auto texts = first.find("streams");
  if (texts == first.end() || !texts->is_array() || texts->size() != options.streams.size())
    throw std::runtime_error("The receiver of streams did not describe them.");
  for (const Json& text : *texts) {
    if (!text.is_string()) throw std::runtime_error("A stream has no description.");
    streams_.push_back(tracks::ParseStream(text));
    const tracks::StreamTrack checked(streams_.back());  // throws if the mapping does not fit
  }
  Json described = Json::array();
  for (tracks::StreamDescription stream : streams_) {
    stream.map.clear();
    described.push_back(TextOf(stream));
  }
  process_->Remember("described", described);
}

int StreamMain() { return ChildMain("streams", Serve); }

}  // namespace predictor::lab_streams
