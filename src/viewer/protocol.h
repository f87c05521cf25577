// Parses the text messages between page and server (docs/reference/viewer-protocol.md) into typed,
// bounded requests, and writes such messages.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/head_record.h"
#include "core/run_input.h"
#include "viewer/admission.h"
#include "viewer/leases.h"

namespace predictor::viewer {

using Json = nlohmann::ordered_json;

inline constexpr std::size_t kLongestMessage = 1024;  // largest message from a page [bytes]
inline constexpr const char* kSubprotocol = "predictor.v1";

struct HelloRequest {
  enum class Kind { kCode, kPin, kToken } kind = Kind::kCode;
  std::string secret;
};
struct HeartbeatRequest {};
struct LeaseRequest {
  LeaseKind what = LeaseKind::kControl;
  bool take = false;
};
struct StopRequest {};
struct ExperimenterRequest {};  // the page wants to show the events that are to come
struct CommandRequest {
  InputKind command = InputKind::kAlign;  // align, start, reset or stop; stop: end as planned
};
struct ParameterRequest {
  Parameter parameter = Parameter::kStiffnessTranslation;
  double value = 0;
};
struct ScenarioRequest {
  std::string name;
};
struct MarkRequest {};
// For replaying a recording.
struct ReplayRequest {
  InputKind what = InputKind::kPlay;  // play, seek or step
  double value = 0;                   // value as in RunInput::value
};
struct HandRequest {
  std::uint8_t hand = 0;  // 0 left, 1 right
  bool grip = false;
  std::array<double, 3> p = {};            // position in W [m]
  std::array<double, 4> q = {1, 0, 0, 0};  // unit, scalar first
};
struct PingRequest {
  double page_ms = 0;
};
// The medians during the last second, measured with the page's clock [ms].
struct LatencyRequest {
  double offset_ms = 0, received_ms = 0, rendered_ms = 0;
};
struct ImmersiveRequest {
  bool active = false;
  std::uint64_t drawn_ns = 0;  // TickRecord::wall_ns of the newest drawn state; 0: none yet
  // The pose of the head, if the page sends it.
  bool has_head = false;
  std::array<double, 3> p = {};                  // position in W [m]
  std::array<double, 4> q = {1, 0, 0, 0};        // unit, scalar first
  std::uint64_t posed_ns = 0;                    // server's clock at the pose; 0: not known
  std::optional<HeadRegistration> registration;  // if the person registered W, and it is valid
};
using PageRequest =
    std::variant<HelloRequest, HeartbeatRequest, LeaseRequest, StopRequest, ExperimenterRequest,
                 CommandRequest, ParameterRequest, ScenarioRequest, MarkRequest, ReplayRequest,
                 HandRequest, PingRequest, LatencyRequest, ImmersiveRequest>;

// Returns nothing if the text is not JSON, if the message's type is unknown, or if a member is
// missing, has the wrong type, is not finite, or exceeds its plausible range. Ignores additional
// members.
std::optional<PageRequest> ParsePageRequest(std::string_view text);

// ---- to the page --------------------------------------------------------------------------------

std::string RefusedText(std::string_view reason);
std::string PongText(double page_ms, std::uint64_t server_ns);
std::string DeniedText(std::string_view what, std::string_view reason);
std::string NoticeText(std::string_view text);
// `results_follow` states whether a server with the results replaces this one, so that the page
// should reconnect.
std::string EndedText(std::string_view text, bool results_follow);
std::string TokenText(std::string_view token);
std::string HeadsetText(std::uint32_t client, const ImmersiveRequest& headset);
// Returns the holders of the leases as {"control": 3 | null, ...}, as in `leases` and `welcome`.
Json LeasesJson(const Leases& leases, std::size_t clients);
std::string LeasesText(const Leases& leases, std::size_t clients);
// Returns the message `key`, which replaces the entry `key` of the scene: `fixtures` or `acting`.
std::string SceneText(const char* key, const Json& value);
Json FrameJson();  // FrameFields() as JSON

}  // namespace predictor::viewer
