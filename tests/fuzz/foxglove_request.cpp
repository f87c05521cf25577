// Passes any text, line by line, as the messages of a Foxglove client, and then publishes states to
// that client.
#include "fuzz/target.h"
#include "scenario/scenario_io.h"
#include "viewer/foxglove.h"

namespace {

class Sink final : public predictor::viewer::Connection {
 public:
  void SendText(std::string text) override { bytes_ += text.size(); }
  void SendNewest(std::uint32_t, predictor::viewer::MessageKind,
                  std::shared_ptr<const std::string> message) override {
    bytes_ += message->size();
  }
  void Close(predictor::viewer::CloseCode, std::string) override { closed = true; }
  void Admitted() override {}
  std::string peer() const override { return "127.0.0.1"; }
  bool closed = false;

 private:
  std::size_t bytes_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static std::uint64_t now = 0;
  static predictor::viewer::Foxglove foxglove(
      predictor::LoadScenario(PREDICTOR_SOURCE_DIR "/scenarios/box_9kg.yaml"), {},
      [] { return now; });
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  Sink connection;
  const auto session = foxglove.Open(&connection);
  while (!rest.empty() && !connection.closed) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    session->OnText(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  now += 1'000'000'000;
  foxglove.Publish(predictor::TickRecord{});
  return 0;
}
