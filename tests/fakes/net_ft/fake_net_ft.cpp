#include "fakes/net_ft/fake_net_ft.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "devices/net_ft/rdt.h"

namespace predictor {
namespace {

class FakeNetFt final : public FakeDevice {
 public:
  explicit FakeNetFt(const FakeOptions& options) : onrobot_(options.contains("onrobot")) {
    const auto number = [&](const char* key, double otherwise) {
      const auto it = options.find(key);
      return it == options.end() ? otherwise : std::stod(it->second);
    };
    rate_ = number("rate", 1000);
    force_ = number("counts", onrobot_ ? 1e4 : 1e6);
    torque_ = number("counts", onrobot_ ? 1e5 : 1e6);
    next_ = static_cast<std::uint32_t>(number("first", 1));
  }

  std::vector<std::uint16_t> udp_ports() const override { return {rdt::kPort}; }

  void ReceivedDatagram(std::uint16_t, std::uint16_t from,
                        std::span<const std::byte> bytes) override {
    const auto request = rdt::DecodeRequest(bytes);
    if (!request) return Log("not a request");
    if (request->command == rdt::Command::kStream) {
      client_ = from;
      left_ = request->count == 0 ? -1 : static_cast<long>(request->count);
    } else if (request->command == rdt::Command::kStop) {
      client_ = 0;
    } else if (request->command == rdt::Command::kBias) {
      bias_ = onrobot_ && request->count == 0 ? Wrench(Wrench::Zero()) : now_;
    } else if (onrobot_ && request->command == rdt::Command::kPeriod && request->count > 0) {
      rate_ = 1e3 / request->count;
    } else if (!(onrobot_ && request->command == rdt::Command::kFilter)) {
      Log("unknown command");
    }
  }

  void Step(Mechanics* mechanics) override {
    if (!frozen_) now_ = mechanics->sample.F_S_raw;
    saturated_ = mechanics->sample.sensor_saturated;
    for (due_ += rate_ * 0.001; due_ >= 1 - 1e-9; due_ -= 1) Send();
  }

  bool Do(const std::string& what) override {
    if (what == "saturate")
      status_ = rdt::kSaturated | rdt::kAnyError;
    else if (what.starts_with("status "))
      status_ = static_cast<std::uint32_t>(std::stoul(what.substr(7), nullptr, 16));
    else if (what == "freeze")
      frozen_ = true;
    else if (what == "silent")
      silent_ = true;
    else if (what == "short")
      short_ = true;
    else if (what == "long")
      long_ = true;
    else if (what == "repeat")
      repeat_ = true;
    else if (what == "back")
      next_ -= 50;
    else if (what == "restart")
      next_ = 1;
    else if (what == "skip")
      next_ += 3;
    else if (what == "well")
      Recover();
    else
      return false;
    return true;
  }

 private:
  void Recover() {
    frozen_ = silent_ = short_ = long_ = repeat_ = false;
    status_ = 0;
  }

  void Send() {
    rdt::Record record;
    record.sequence = repeat_ ? next_ - 1 : next_++;
    record.sample = record.sequence * 7;
    if (client_ == 0 || left_ == 0 || silent_) return;
    left_ -= left_ > 0;
    record.status = status_ | (saturated_ ? rdt::kSaturated | rdt::kAnyError : 0);
    for (int i = 0; i < 6; ++i)
      record.counts[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(
          std::clamp(std::round((now_[i] - bias_[i]) * (i < 3 ? force_ : torque_)), -2147483648.0,
                     2147483647.0));
    std::array<std::byte, rdt::kRecordBytes + 1> bytes{};
    std::ranges::copy(rdt::Encode(record), bytes.begin());
    wire().SendDatagram(
        rdt::kPort, client_,
        std::span(bytes).first(rdt::kRecordBytes - (short_ ? 1U : 0U) + (long_ ? 1U : 0U)));
  }

  bool onrobot_;
  double rate_, force_, torque_, due_ = 0;
  std::uint32_t next_;
  std::uint16_t client_ = 0;
  long left_ = 0;
  Wrench now_ = Wrench::Zero(), bias_ = Wrench::Zero();
  std::uint32_t status_ = 0;
  bool frozen_ = false, silent_ = false, short_ = false, long_ = false, repeat_ = false,
       saturated_ = false;
};

}  // namespace

std::unique_ptr<FakeDevice> MakeFakeNetFt(const FakeOptions& options) {
  return std::make_unique<FakeNetFt>(options);
}

}  // namespace predictor
