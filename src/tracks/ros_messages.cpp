#include "tracks/ros_messages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor::tracks {
// Reads untrusted CDR. After the header of four bytes, each number is aligned according to its
// size.
class Cdr {
 public:
  explicit Cdr(std::string_view bytes) {
    ok_ = bytes.size() >= 4 && bytes[0] == 0 && (bytes[1] == 0 || bytes[1] == 1);
    if (!ok_) return;
    swapped_ = bytes[1] == 0;
    rest_ = bytes.substr(4);
  }
  bool ok() const { return ok_; }

  template <class T>
  T Number() {
    at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    if (at_ > rest_.size() || rest_.size() - at_ < sizeof(T)) ok_ = false;
    if (!ok_) return {};
    char raw[sizeof(T)];
    std::memcpy(raw, rest_.data() + at_, sizeof(T));
    if (swapped_) std::reverse(raw, raw + sizeof(T));
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }
  std::string Text() {
    const std::size_t n = Number<std::uint32_t>();
    if (!ok_ || n > rest_.size() - at_) ok_ = false;
    if (!ok_) return {};
    std::string text(rest_.substr(at_, n > 0 ? n - 1 : 0));  // without the final zero
    at_ += n;
    return text;
  }
  // Returns the number of entries that follow. Each entry has at least `bytes` bytes.
  std::size_t Count(std::size_t bytes) {
    const std::size_t n = Number<std::uint32_t>();
    if (!ok_ || n > (rest_.size() - at_) / bytes) ok_ = false;
    return ok_ ? n : 0;
  }

 private:
  std::string_view rest_;
  std::size_t at_ = 0;
  bool ok_ = false, swapped_ = false;
};

namespace {

struct Field {
  const char* name;
  const char* unit;
};
constexpr const char* kMetre = "m";
const std::vector<Field> kPoint = {{"x", kMetre}, {"y", kMetre}, {"z", kMetre}};
const std::vector<Field> kVector = {{"x", ""}, {"y", ""}, {"z", ""}};
const std::vector<Field> kQuaternion = {{"x", ""}, {"y", ""}, {"z", ""}, {"w", ""}};
const std::vector<Field> kPose = {
    {"position.x", kMetre}, {"position.y", kMetre}, {"position.z", kMetre}, {"orientation.x", ""},
    {"orientation.y", ""},  {"orientation.z", ""},  {"orientation.w", ""}};
const std::vector<Field> kTransform = {{"translation.x", kMetre}, {"translation.y", kMetre},
                                       {"translation.z", kMetre}, {"rotation.x", ""},
                                       {"rotation.y", ""},        {"rotation.z", ""},
                                       {"rotation.w", ""}};
const std::vector<Field> kWrench = {{"force.x", "N"},    {"force.y", "N"},    {"force.z", "N"},
                                    {"torque.x", "N m"}, {"torque.y", "N m"}, {"torque.z", "N m"}};
const std::vector<Field> kNumber = {{"data", ""}};

// Reads messages that begin with a sequence of float64 numbers. `prefix` is the name of the group
// that follows a header.
struct Layout {
  bool stamped;
  std::string prefix;
  bool has_child_frame;
  const std::vector<Field>* fields;
};

const std::map<std::string, Layout>& Layouts() {
  static const std::map<std::string, Layout> kLayouts = {
      {"geometry_msgs/Point", {false, "", false, &kPoint}},
      {"geometry_msgs/PointStamped", {true, "point.", false, &kPoint}},
      {"geometry_msgs/Vector3", {false, "", false, &kVector}},
      {"geometry_msgs/Vector3Stamped", {true, "vector.", false, &kVector}},
      {"geometry_msgs/Quaternion", {false, "", false, &kQuaternion}},
      {"geometry_msgs/QuaternionStamped", {true, "quaternion.", false, &kQuaternion}},
      {"geometry_msgs/Pose", {false, "", false, &kPose}},
      {"geometry_msgs/PoseStamped", {true, "pose.", false, &kPose}},
      {"geometry_msgs/PoseWithCovarianceStamped", {true, "pose.pose.", false, &kPose}},
      {"nav_msgs/Odometry", {true, "pose.pose.", true, &kPose}},
      {"geometry_msgs/Wrench", {false, "", false, &kWrench}},
      {"geometry_msgs/WrenchStamped", {true, "wrench.", false, &kWrench}},
      {"geometry_msgs/TransformStamped", {true, "transform.", true, &kTransform}},
      {"std_msgs/Float64", {false, "", false, &kNumber}}};
  return kLayouts;
}

constexpr const char* kJointState = "sensor_msgs/JointState";
constexpr const char* kTransforms = "tf2_msgs/TFMessage";  // a list of these:
constexpr const char* kTransformStamped = "geometry_msgs/TransformStamped";
constexpr std::size_t kTransformBytes = 72;  // smallest size [bytes]
constexpr std::size_t kMaxFrames = 1000;     // maximum number per topic

// "geometry_msgs/msg/Pose" and "geometry_msgs/Pose" are the same.
std::string ShortType(const std::string& type) {
  const std::size_t msg = type.find("/msg/");
  return msg == std::string::npos ? type : type.substr(0, msg) + type.substr(msg + 4);
}

// Returns the stamp of a header [s], or 0 if it was not set. Reads the whole header.
double StampOf(Cdr* cdr) {
  const auto seconds = cdr->Number<std::int32_t>();
  const auto nanoseconds = cdr->Number<std::uint32_t>();
  cdr->Text();
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(nanoseconds);
}

}  // namespace

RosTopic::RosTopic(std::string topic, const std::string& type)
    : topic_(std::move(topic)), type_(ShortType(type)) {}

bool RosTopic::IsKnown(const std::string& type) {
  const std::string known = ShortType(type);
  return known == kJointState || known == kTransforms || Layouts().contains(known);
}

void RosTopic::Put(const std::string& field, const char* unit, double value) {
  auto [found, added] = channels_.try_emplace(field);
  Series& series = found->second;
  if (added) {
    series.name = topic_ + "." + field;
    series.unit = unit;
    order_.push_back(field);
  }
  series.values.resize(times_.size() - 1, kMissing);
  series.values.push_back(std::isfinite(value) ? value : kMissing);
}

void RosTopic::Add(std::string_view bytes, std::int64_t received, MessageTime clock) {
  Cdr cdr(bytes);
  if (type_ == kTransforms)
    AddTransforms(&cdr, received, clock);
  else
    AddOne(&cdr, received, clock);
  if (!cdr.ok())
    throw InputError(topic_,
                     "A message cannot be read as " + type_ + " in CDR. Record the topic again.");
}

void RosTopic::AddTransforms(Cdr* cdr, std::int64_t received, MessageTime clock) {
  const std::size_t n = cdr->Count(kTransformBytes);
  for (std::size_t i = 0; i < n && cdr->ok(); ++i) {
    Cdr ahead = *cdr;
    StampOf(&ahead);
    const std::string name = topic_ + "[" + ahead.Text() + "]";
    if (!ahead.ok()) break;
    auto frame = std::ranges::find(frames_, name, &RosTopic::topic_);
    if (frame == frames_.end() && frames_.size() == kMaxFrames)
      throw InputError(topic_, "The topic has transforms of more than 1000 frames.");
    if (frame == frames_.end()) frame = frames_.emplace(frame, name, kTransformStamped);
    frame->AddOne(cdr, received, clock);
  }
}

void RosTopic::AddOne(Cdr* cdr, std::int64_t received, MessageTime clock) {
  const auto found = Layouts().find(type_);
  const bool stamped = found == Layouts().end() || found->second.stamped;
  double time = 1e-9 * static_cast<double>(received);
  if (stamped) {
    const double stamp = StampOf(cdr);
    if (clock == MessageTime::kStamp && stamp != 0) time = stamp;
  }
  const bool again = !times_.empty() && times_.back() == time;
  if (!again) times_.push_back(time);
  const auto put = [&](const std::string& field, const char* unit, double value) {
    if (cdr->ok() && !again) Put(field, unit, value);
  };
  if (found != Layouts().end()) {
    if (found->second.has_child_frame) cdr->Text();
    for (const Field& field : *found->second.fields)
      put(found->second.prefix + field.name, field.unit, cdr->Number<double>());
  } else {
    std::vector<std::string> joints(cdr->Count(4));
    for (std::string& joint : joints) joint = cdr->Text();
    for (const char* what : {"position", "velocity", "effort"}) {
      const std::size_t n = cdr->Count(8);
      for (std::size_t i = 0; i < n; ++i) {
        const double value = cdr->Number<double>();
        if (i < joints.size()) put(std::string(what) + "[" + joints[i] + "]", "", value);
      }
    }
  }
}

void RosTopic::Finish(const std::string& file, std::vector<Series>* series) {
  for (RosTopic& frame : frames_) frame.Finish(file, series);
  for (std::size_t i = 1; i < times_.size(); ++i)
    if (times_[i] < times_[i - 1])
      throw InputError(file,
                       Formatted("The time stamps of %s go back from %.3f to %.3f s. Use the times "
                                 "at which the messages were received (time: received).",
                                 Printable(topic_).c_str(), times_[i - 1], times_[i]));
  if (times_.size() < 2) return;
  const auto times = std::make_shared<const std::vector<double>>(std::move(times_));
  for (const std::string& field : order_) {
    Series& one = channels_[field];
    one.values.resize(times->size(), kMissing);
    one.times = times;
    series->push_back(std::move(one));
  }
}

}  // namespace predictor::tracks
