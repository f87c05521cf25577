#include "recording/head_stream.h"

#include <nlohmann/json.hpp>

namespace predictor {
namespace recording {
namespace {

using Json = nlohmann::ordered_json;

bool Read(const Json& object, const char* name, double* x) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return false;
  *x = found->get<double>();
  return true;
}

template <std::size_t N>
bool Read(const Json& object, const char* name, std::array<double, N>* x) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_array() || found->size() != N) return false;
  for (std::size_t i = 0; i < N; ++i) {
    if (!(*found)[i].is_number()) return false;
    (*x)[i] = (*found)[i].template get<double>();
  }
  return true;
}

Json NumberSchema(const char* meaning) { return {{"type", "number"}, {"description", meaning}}; }

Json ListSchema(int count, const char* meaning) {
  return {{"type", "array"},
          {"items", {{"type", "number"}}},
          {"minItems", count},
          {"maxItems", count},
          {"description", meaning}};
}

}  // namespace

std::string HeadJson(const HeadRecord& head) {
  const HeadRegistration& r = head.registration;
  return Json{{"p", head.p},
              {"q", head.q},
              {"delay", head.delay},
              {"registration", {{"yaw", r.yaw}, {"t", r.t}, {"residual", r.residual}}}}
      .dump();
}

std::string HeadSchema() {
  const Json registration = {
      {"type", "object"},
      {"description", "place of W in the headset's space (Z up), as the person registered it"},
      {"properties",
       {{"yaw", NumberSchema("[rad] rotation of W about the vertical")},
        {"t", ListSchema(3, "[m] origin of W")},
        {"residual", NumberSchema("[m] root mean square over the touched points")}}},
      {"required", {"yaw", "t", "residual"}}};
  return Json{{"type", "object"},
              {"description",
               "measured pose of the head in W, at the message's time: the frame between the eyes, "
               "x forward, y left, z up"},
              {"properties",
               {{"p", ListSchema(3, "[m]")},
                {"q", ListSchema(4, "unit quaternion, scalar first")},
                {"delay", NumberSchema("[s] time until the viewer received the pose")},
                {"registration", registration}}},
              {"required", {"p", "q", "delay", "registration"}}}
      .dump();
}

bool ParseHead(std::string_view text, HeadRecord* head) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return false;
  const auto r = json.find("registration");
  if (r == json.end() || !r->is_object()) return false;
  return Read(json, "p", &head->p) && Read(json, "q", &head->q) &&
         Read(json, "delay", &head->delay) && Read(*r, "yaw", &head->registration.yaw) &&
         Read(*r, "t", &head->registration.t) &&
         Read(*r, "residual", &head->registration.residual) && IsPlausible(*head);
}

}  // namespace recording

JsonChannel HeadChannel() {
  return {kHeadTopic, "predictor.HeadPose", recording::HeadSchema(), {}};
}

}  // namespace predictor
