// Handles any stream as a complete session with Unity, in both dialects.
#include "ros_tcp/ros_session.h"

#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const predictor::ros_tcp::RosTopics topics(predictor::Scenario{}, {"joint"}, {});
  static const predictor::TickRecord record{};
  for (const auto dialect :
       {predictor::ros_tcp::RosDialect::kRos1, predictor::ros_tcp::RosDialect::kRos2}) {
    predictor::ros_tcp::FrameReader reader;
    predictor::ros_tcp::RosSession session(&topics, dialect, [] {});
    reader.Feed({reinterpret_cast<const char*>(data), size});
    while (const auto frame = reader.Next()) (void)session.OnFrame(*frame);
    (void)session.Select(topics.Publish(record, dialect, 0, 0));
  }
  return 0;
}
