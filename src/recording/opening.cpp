#include "recording/opening.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "core/text.h"
#include "recording/encoder.h"
#include "recording/preamble.h"
#include "recording/schema.h"

namespace predictor::recording {
namespace {

constexpr std::uint64_t kLargestPreamble = 128U << 20U;  // [bytes]
constexpr std::size_t kMaxPreambleRecords = 10'000;
constexpr double kShortestTick = 1e-4, kLongestTick = 1;  // [s]

template <class T>
bool ParseNumber(const std::string& text, T* x) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *x);
  return error == std::errc{} && end == text.data() + text.size();
}

std::string Entry(const mcap::Map& map, const char* key) {
  const auto it = map.find(key);
  return it == map.end() ? std::string() : it->second;
}

// The run's metadata, with or without its CRC, and the length of its record.
struct RunRecord {
  mcap::Map map;
  std::uint64_t bytes = 0;
  bool proven() const { return Entry(map, kCrc) == CrcOfRun(map); }
};
std::optional<RunRecord> RunAt(const InputFile& file, std::uint64_t at) {
  const auto head = ReadHead(file, at);
  if (!head || head->op != mcap::Op::kMetadata || head->length > kLargestRun) return {};
  const std::string content = file.Read(at + mcap::kHead, head->length);
  mcap::Parser from{content};
  if (from.String() != kRunMetadata) return {};
  RunRecord run{from.Strings(), mcap::kHead + head->length};
  if (!from.ok || !from.rest.empty()) return {};
  return run;
}

// Returns the start of an attachment with this name, up to its data.
std::string CopyHead() { return mcap::Bytes().String(kCopy).String(kBytes).text; }
constexpr std::uint64_t kCopyNameAt = mcap::kHead + 8 + 8;  // position in the attachment's record

// Returns the start of the data of the copy whose run metadata are intact, or no value if there is
// none.
std::optional<std::uint64_t> FindCopy(const InputFile& file) {
  constexpr std::uint64_t kFarthest = kLargestPreamble + 2 * kLargestChunk;
  constexpr int kMaxTries = 16;  // limit, because a hostile file may contain many
  MarkFinder finder(file, CopyHead(), kCopyNameAt, mcap::Op::kAttachment, kFarthest);
  std::uint64_t at = finder.Next(0);
  for (int tried = 0; at < finder.end() && tried < kMaxTries; ++tried, at = finder.Next(at + 1)) {
    const std::uint64_t data = at + kCopyNameAt + CopyHead().size() + 8;
    const auto run = RunAt(file, data);
    if (run && run->proven()) return data;
  }
  return {};
}

// Describes the consequences of the loss of a part to the user.
std::string Consequence(const std::string& name) {
  if (name == kScenarioFile)
    return "without it, the run cannot be shown, recomputed, reported or used to identify "
           "friction; `export data` and `compare` still work";
  if (name == kMachineFile) return "the arms and the limits of the run are no longer known";
  if (name == kLabelMetadata) return "the labels of the run are no longer known";
  if (name == kModelMetadata)
    return "it is unknown whether this program's models are the models of the run";
  if (name == kTopics) return "the scene for Foxglove cannot be read, but the ticks can";
  return "the scenario needs it: the run can be shown or recomputed only where another copy exists";
}

class OpeningReader {
 public:
  explicit OpeningReader(const InputFile& file) : file_(file) {}

  Opening Read() {
    const mcap::Map run = FindRun();
    TakeRun(run);
    std::istringstream contents(Entry(run, kContents));
    std::uint64_t bytes = 0, crc = 0, at = start_, copied_at = copy_start_;
    std::size_t pieces = 0;
    int copied = 0;
    for (std::string name; contents >> bytes >> crc >> copied && contents.get() == ' ' &&
                           std::getline(contents, name);) {
      if (++pieces > kMaxPreambleRecords || bytes > kLargestPreamble ||
          at + bytes > start_ + kLargestPreamble)
        TooMuch(at);
      TakePiece({name, at, copied != 0 ? copied_at : 0, bytes, crc});
      at += bytes;
      if (copied != 0) copied_at += bytes;
    }
    opening_.end = at;
    if (at > file_.size())
      file_.Fail(file_.size(), "The recording ends before its first tick, so it is empty.");
    CheckTopics(Entry(run, kLayout));
    DescribeDamage();
    return std::move(opening_);
  }

 private:
  struct Piece {
    std::string name;
    std::uint64_t at, copied_at;  // 0: not copied; position after the run's metadata in the copy
    std::uint64_t bytes, crc;
  };

  [[noreturn]] void TooMuch(std::uint64_t at) const {
    file_.Fail(at, "The recording has more data before the first tick than this program writes.");
  }

  // Reads the metadata from its original place or from the copy.
  mcap::Map FindRun() {
    const std::uint64_t at = Beginning().size();
    if (file_.size() < at || file_.Read(0, at) != Beginning()) opening_.damaged = true;
    auto run = RunAt(file_, at);
    const bool there = run && run->proven();
    if (!there) {
      opening_.damaged = true;
      auto again = Copy() ? RunAt(file_, *Copy()) : std::nullopt;
      if (!again) FailWithout(run);
      run = std::move(again);
    }
    start_ = at + run->bytes;
    copy_start_ = run->bytes;
    return run->map;
  }

  std::optional<std::uint64_t> Copy() {
    if (!copy_) copy_ = FindCopy(file_);
    return *copy_;
  }

  // Throws because the description of the run is damaged in both places.
  [[noreturn]] void FailWithout(const std::optional<RunRecord>& run) const {
    const std::uint64_t at = Beginning().size();
    const auto head = ReadHead(file_, mcap::kMagic.size());
    if (file_.size() < mcap::kMagic.size() || file_.Read(0, mcap::kMagic.size()) != mcap::kMagic)
      file_.Fail(0, "This is not a recording: it does not start like an MCAP file.");
    if (head && head->op == mcap::Op::kHeader && file_.size() >= at &&
        file_.Read(0, at) != Beginning())
      file_.Fail(0, "This MCAP file was not recorded by this program.");
    if (run && Entry(run->map, "format") != kFormat) OtherFormat(run->map);
    file_.Fail(at,
               "The recording is truncated or damaged before its first tick, and there is no "
               "second copy of that part. Nothing can be read.");
  }
  [[noreturn]] void OtherFormat(const mcap::Map& run) const {
    file_.Fail(Beginning().size(), "The recording has format " + Quote(Entry(run, "format")) +
                                       ", but this program reads format " + kFormat +
                                       ". Use the program that recorded it "
                                       "(version " +
                                       Quote(Entry(run, "version")) + ").");
  }

  void TakeRun(const mcap::Map& run) {
    const std::uint64_t at = Beginning().size();
    if (Entry(run, "format") != kFormat) OtherFormat(run);
    RecordingHeader& header = opening_.header;
    header.scenario_name = Entry(run, "scenario");
    header.program_version = Entry(run, "version");
    header.engine = Entry(run, "engine");
    if (!ParseNumber(Entry(run, "seed"), &header.seed) ||
        !ParseNumber(Entry(run, "dt"), &header.dt) ||
        !ParseNumber(Entry(run, "start_unix_ns"), &header.start_unix_ns))
      file_.Fail(at,
                 "The recording's data about its run are invalid. The recording was not written by "
                 "this program.");
    if (PredictedLoop loop; ParseNumber(Entry(run, kLead), &loop.lead) &&
                            ParseNumber(Entry(run, kMargin), &loop.margin) &&
                            std::isfinite(loop.lead) && std::isfinite(loop.margin))
      header.loop = loop;
    if (!(header.dt >= kShortestTick && header.dt <= kLongestTick))
      file_.Fail(
          at,
          "According to the recording, its ticks last " + Entry(run, "dt") +
              " s. Valid ticks last 0.0001 to 1 s. The recording was not written by this program.");
  }

  std::optional<std::string> Proven(std::uint64_t at, const Piece& piece) const {
    if (at > file_.size() || piece.bytes > file_.size() - at) return {};
    std::string bytes = file_.Read(at, piece.bytes);
    if (mcap::Crc(bytes) != piece.crc) return {};
    return bytes;
  }

  void TakePiece(const Piece& piece) {
    auto bytes = Proven(piece.at, piece);
    if (!bytes) {
      opening_.damaged = true;
      if (piece.copied_at != 0)
        if (const auto copy = Copy()) bytes = Proven(*copy + piece.copied_at, piece);
    }
    if (!bytes) {
      opening_.header.lost.push_back(piece.name);
      return;
    }
    mcap::Parser from{*bytes};
    while (from.ok && !from.rest.empty()) {
      if (++records_ > kMaxPreambleRecords) TooMuch(piece.at);
      const auto op = from.Number<mcap::Op>();
      const std::uint64_t length = from.U64();
      from.ok = from.ok && TakeRecord(op, mcap::Parser{from.Take(length)});
    }
    if (!from.ok)
      file_.Fail(piece.at,
                 "The recording has invalid data before the first tick, or more data than this "
                 "program writes there.");
  }

  bool TakeRecord(mcap::Op op, mcap::Parser from) {
    switch (op) {
      case mcap::Op::kSchema:
        return TakeSchema(from);
      case mcap::Op::kChannel:
        return TakeChannel(from);
      case mcap::Op::kAttachment:
        return TakeAttachment(from);
      case mcap::Op::kMetadata:
        return TakeMetadata(from);
      default:
        return false;
    }
  }

  bool TakeSchema(mcap::Parser from) {
    const std::uint16_t id = from.U16();
    const std::string name(from.String());
    from.String();
    schemas_[id] = {name, std::string(from.String())};
    return from.ok;
  }
  // All topics that are not the program's own belong to the scene.
  bool TakeChannel(mcap::Parser from) {
    const std::uint16_t id = from.U16();
    const auto schema = schemas_.find(from.U16());
    const std::string topic(from.String());
    if (!from.ok || schema == schemas_.end()) return false;
    topics_[id] = {topic, schema->second.second};
    if (id < kFirstJsonChannel) return true;
    opening_.scene.push_back({topic, schema->second.first, schema->second.second, {}});
    return id + 1U == kFirstJsonChannel + opening_.scene.size();
  }
  bool TakeAttachment(mcap::Parser from) {
    from.U64(), from.U64();
    const std::string name(from.String()), media_type(from.String());
    std::string data(from.Take(from.U64()));
    if (!from.ok) return false;
    if (name == kScenarioFile)
      opening_.header.scenario_yaml = std::move(data);
    else if (name == kMachineFile)
      opening_.header.machine_yaml = std::move(data);
    else
      opening_.header.attachments.push_back({name, media_type, std::move(data)});
    return true;
  }
  bool TakeMetadata(mcap::Parser from) {
    const std::string name(from.String());
    const mcap::Map map = from.Strings();
    if (name == kLabelMetadata) opening_.header.labels = map;
    if (name == kModelMetadata) opening_.header.model_hashes = map;
    if (name == kLostMetadata)
      for (const auto& [lost, how] : map) opening_.header.lost.push_back(lost);
    return from.ok;
  }

  // Checks that the file's ticks have the layout of this program's ticks.
  void CheckTopics(const std::string& layout) const {
    const std::vector<std::string>& lost = opening_.header.lost;
    if (std::find(lost.begin(), lost.end(), kTopics) != lost.end() && topics_.empty()) {
      if (layout != LayoutCrc()) OtherFields("ticks");
      return;
    }
    for (int g = 0; g < kTickGroupCount; ++g) {
      const auto group = static_cast<TickGroup>(g);
      Expect(ChannelOf(group), kTickGroups[static_cast<std::size_t>(g)].topic, Definition(group));
    }
    Expect(kSnapshotChannel, kSnapshotTopic, kSnapshotDefinition);
    Expect(kEventChannel, kEventsTopic, EventSchema());
  }
  void Expect(std::uint16_t channel, const std::string& topic,
              const std::string& definition) const {
    const auto it = topics_.find(channel);
    if (it == topics_.end() || it->second.first != topic ||
        (it->second.second != definition && Layout(it->second.second) != Layout(definition)))
      OtherFields("topic " + topic);
  }
  [[noreturn]] void OtherFields(const std::string& what) const {
    file_.Fail(0, "The recording's " + what + (what == "ticks" ? " have" : " has") +
                      " different fields from those of this program. Use the program that recorded "
                      "it (version " +
                      Quote(opening_.header.program_version) + ").");
  }

  void DescribeDamage() {
    std::vector<std::string>& lost = opening_.header.lost;
    std::sort(lost.begin(), lost.end());
    lost.erase(std::unique(lost.begin(), lost.end()), lost.end());
    if (opening_.damaged)
      opening_.damage =
          "The recording is damaged before its first tick. The intact parts were read from the "
          "start of the file or from the copy behind the first chunk.";
    for (const std::string& name : lost)
      opening_.damage +=
          (opening_.damage.empty() ? "`" : " `") + name + "` is lost: " + Consequence(name) + ".";
  }

  const InputFile& file_;
  Opening opening_;
  // The position after the run's metadata in the original, and the same position in the copy.
  std::uint64_t start_ = 0, copy_start_ = 0;
  // The position at which the copy's data start. The outer optional is empty until this position
  // has been searched for.
  std::optional<std::optional<std::uint64_t>> copy_;
  std::size_t records_ = 0;
  std::map<std::uint16_t, std::pair<std::string, std::string>> schemas_;  // name, text
  std::map<std::uint16_t, std::pair<std::string, std::string>> topics_;   // name, schema's text
};

}  // namespace

Opening ReadOpening(const InputFile& file) { return OpeningReader(file).Read(); }

bool IsBetweenChunks(const InputFile& file, std::uint64_t offset, const RecordHead& head) {
  constexpr std::uint64_t kBeforeEntries = 2 + 4, kCrcBytes = 4;
  if (head.op == mcap::Op::kMessageIndex && head.length >= kBeforeEntries) {
    const std::string bytes = file.Read(offset + mcap::kHead, kBeforeEntries);
    mcap::Parser from{bytes};
    from.U16();
    return head.length == kBeforeEntries + from.U32();
  }
  if (head.op != mcap::Op::kAttachment || head.length > kLargestCopy + 1024 ||
      head.length < kCopyNameAt + CopyHead().size() + 8 + kCrcBytes)
    return false;
  const std::string content = file.Read(offset + mcap::kHead, head.length);
  const std::size_t checked = content.size() - kCrcBytes;
  mcap::Parser crc{std::string_view(content).substr(checked)};
  return content.compare(kCopyNameAt - mcap::kHead, CopyHead().size(), CopyHead()) == 0 &&
         mcap::Crc(std::string_view(content).substr(0, checked)) == crc.U32();
}

}  // namespace predictor::recording
