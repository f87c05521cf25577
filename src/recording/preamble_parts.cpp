#include "recording/preamble_parts.h"

#include "recording/preamble.h"
#include "recording/schema.h"

namespace predictor::recording {

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

}  // namespace predictor::recording
