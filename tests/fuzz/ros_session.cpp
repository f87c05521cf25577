// Any stream as a whole session of Unity's, in both dialects.
#include "ros_tcp/ros_session.h"

#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const predictor::RosTopics topics(predictor::Scenario{}, {"joint"}, {});
  static const predictor::TickRecord record{};
  for (const auto dialect : {predictor::RosDialect::kRos1, predictor::RosDialect::kRos2}) {
    predictor::FrameReader reader;
    predictor::RosSession session(&topics, dialect, [] {});
    reader.Feed({reinterpret_cast<const char*>(data), size});
    while (const auto frame = reader.Next()) (void)session.OnFrame(*frame);
    (void)session.Select(topics.Publish(record, dialect, 0, 0));
  }
  return 0;
}
