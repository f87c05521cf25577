#include "recording/preamble.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/text.h"
#include "recording/encoder.h"
#include "recording/schema.h"

namespace predictor::recording {
namespace {

class PreambleBuilder {
 public:
  void AddSchema(std::uint16_t id, const std::string& name, const std::string& encoding,
                 const std::string& text) {
    mcap::Bytes content;
    content.U16(id).String(name).String(encoding).String(text);
    preamble_.schemas.push_back(mcap::Record(mcap::Op::kSchema, content.text));
    topics_ += preamble_.schemas.back();
  }
  void AddChannel(std::uint16_t id, std::uint16_t schema, const std::string& topic,
                  const std::string& encoding) {
    mcap::Bytes content;
    content.U16(id).U16(schema).String(topic).String(encoding).Strings({});
    preamble_.channels.push_back(mcap::Record(mcap::Op::kChannel, content.text));
    topics_ += preamble_.channels.back();
  }
  void AddMetadata(const std::string& name, const mcap::Map& map) {
    pieces_.push_back({name, MetadataRecord(name, map), mcap::Op::kMetadataIndex,
                       mcap::Bytes().String(name).text});
  }
  void AddAttachment(const mcap::Attachment& attachment) {
    pieces_.push_back({attachment.name, ToRecord(attachment), mcap::Op::kAttachmentIndex,
                       mcap::IndexOf(attachment)});
  }
  // Returns the whole preamble, including the run's metadata with the table of contents.
  Preamble Take(mcap::Map run, std::uint64_t time) {
    pieces_.push_back({kTopics, std::move(topics_), mcap::Op::kSchema, ""});
    run[kContents] = Contents();
    run[kCrc] = CrcOfRun(run);
    Piece first{kRunMetadata, MetadataRecord(kRunMetadata, run), mcap::Op::kMetadataIndex,
                mcap::Bytes().String(kRunMetadata).text};
    first.copied = true;
    preamble_.bytes = Beginning();
    preamble_.copy = {kCopy, kBytes, time, ""};
    Put(first);
    for (const Piece& piece : pieces_) Put(piece);
    return std::move(preamble_);
  }

 private:
  struct Piece {
    std::string name, bytes;
    mcap::Op index_op;
    std::string index;  // index entry after the record's position
    bool copied = false;
  };

  static std::string MetadataRecord(const std::string& name, const mcap::Map& map) {
    return mcap::Record(mcap::Op::kMetadata, mcap::Bytes().String(name).Strings(map).text);
  }
  // Returns one line for each part. The line contains the part's length, its CRC, whether the part
  // is copied, and its name.
  std::string Contents() {
    std::string lines;
    std::uint64_t copied = 0;
    for (Piece& piece : pieces_) {
      const std::uint64_t bytes = piece.bytes.size();
      piece.copied = bytes <= kLargestCopied && copied + bytes + kLargestRun <= kLargestCopy;
      if (piece.copied) copied += bytes;
      std::string name = piece.name;
      std::replace(name.begin(), name.end(), '\n', ' ');
      lines += std::to_string(bytes) + " " + std::to_string(mcap::Crc(piece.bytes)) + " " +
               (piece.copied ? "1 " : "0 ") + name + "\n";
    }
    return lines;
  }
  void Put(const Piece& piece) {
    mcap::Bytes index;
    index.U64(preamble_.bytes.size()).U64(piece.bytes.size()).text += piece.index;
    if (piece.index_op == mcap::Op::kMetadataIndex) {
      preamble_.metadata_indexes += mcap::Record(piece.index_op, index.text);
      ++preamble_.metadata;
    } else if (piece.index_op == mcap::Op::kAttachmentIndex) {
      preamble_.attachment_indexes += mcap::Record(piece.index_op, index.text);
      ++preamble_.attachments;
    }
    preamble_.bytes += piece.bytes;
    if (piece.copied) preamble_.copy.data += piece.bytes;
  }

  Preamble preamble_;
  std::string topics_;
  std::vector<Piece> pieces_;
};

void AddTopics(const std::vector<JsonChannel>& scene, PreambleBuilder* preamble) {
  // Both hands use the same schema.
  std::map<std::string, std::uint16_t> schemas;
  for (int g = 0; g < kTickGroupCount; ++g) {
    const TickGroupRow& name = kTickGroups[static_cast<std::size_t>(g)];
    const auto id = static_cast<std::uint16_t>(schemas.size() + 1);
    if (schemas.emplace(name.type, id).second)
      preamble->AddSchema(id, name.type, "ros2msg", Definition(static_cast<TickGroup>(g)));
    preamble->AddChannel(ChannelOf(static_cast<TickGroup>(g)), schemas[name.type], name.topic,
                         "cdr");
  }
  auto next = static_cast<std::uint16_t>(schemas.size() + 1);
  preamble->AddSchema(next, kSnapshotType, "ros2msg", kSnapshotDefinition);
  preamble->AddChannel(kSnapshotChannel, next++, kSnapshotTopic, "cdr");
  preamble->AddSchema(next, kEventType, "jsonschema", EventSchema());
  preamble->AddChannel(kEventChannel, next++, kEventsTopic, "json");
  std::uint16_t channel = kFirstJsonChannel;
  for (const JsonChannel& json : scene) {
    preamble->AddSchema(next, json.schema_name, "jsonschema", json.schema);
    preamble->AddChannel(channel++, next++, json.topic, "json");
  }
}

}  // namespace

std::uint16_t ChannelOf(const std::vector<JsonChannel>& scene, std::string_view topic) {
  for (std::size_t i = 0; i < scene.size(); ++i)
    if (scene[i].topic == topic) return static_cast<std::uint16_t>(kFirstJsonChannel + i);
  return 0;
}

const std::string& Beginning() {
  static const std::string kBeginning =
      std::string(mcap::kMagic) +
      mcap::Record(mcap::Op::kHeader, mcap::Bytes().String("ros2").String("predictor").text);
  return kBeginning;
}

std::string CrcOfRun(mcap::Map run) {
  run.erase(kCrc);
  return std::to_string(mcap::Crc(mcap::Bytes().Strings(run).text));
}

std::string LayoutCrc() {
  std::string all;
  for (int g = 0; g < kTickGroupCount; ++g)
    all += kTickGroups[static_cast<std::size_t>(g)].topic +
           Layout(Definition(static_cast<TickGroup>(g)));
  all += kSnapshotTopic + Layout(kSnapshotDefinition) + kEventsTopic + EventSchema();
  return std::to_string(mcap::Crc(all));
}

Preamble MakePreamble(const RecordingHeader& header, const std::vector<JsonChannel>& scene) {
  PreambleBuilder preamble;
  preamble.AddMetadata(kLabelMetadata, header.labels);
  preamble.AddMetadata(kModelMetadata, header.model_hashes);
  if (!header.lost.empty()) {
    mcap::Map lost;
    for (const std::string& name : header.lost) lost[name] = "damaged";
    preamble.AddMetadata(kLostMetadata, lost);
  }
  const auto time = static_cast<std::uint64_t>(header.start_unix_ns);
  if (!header.scenario_yaml.empty())
    preamble.AddAttachment({kScenarioFile, "application/yaml", time, header.scenario_yaml});
  if (!header.machine_yaml.empty())
    preamble.AddAttachment({kMachineFile, "application/yaml", time, header.machine_yaml});
  for (const RecordingAttachment& file : header.attachments)
    preamble.AddAttachment({file.name, file.media_type, time, file.bytes});
  AddTopics(scene, &preamble);
  mcap::Map run{{"format", kFormat},
                {"scenario", header.scenario_name},
                {"version", header.program_version},
                {"engine", header.engine},
                {"seed", std::to_string(header.seed)},
                {"dt", FormatNumber(header.dt)},
                {"start_unix_ns", std::to_string(header.start_unix_ns)},
                {kLayout, LayoutCrc()}};
  if (header.loop) {
    run[kLead] = FormatNumber(header.loop->lead);
    run[kMargin] = FormatNumber(header.loop->margin);
  }
  return preamble.Take(std::move(run), time);
}

}  // namespace predictor::recording
