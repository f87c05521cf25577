// Foxglove's well-known schemas. Foxglove defines these schemas. A test compares the schemas, field
// by field, with the schemas in Foxglove's own packages.
#include <algorithm>

#include "foxglove/json.h"

namespace predictor::foxglove {
namespace {

Json Unsigned() { return {{"type", "integer"}, {"minimum", 0}}; }
Json Truth() { return {{"type", "boolean"}}; }

Json Enumeration(const char* title, std::initializer_list<const char*> names) {
  Json choices = Json::array();
  for (const char* name : names) choices.push_back({{"title", name}, {"const", choices.size()}});
  return {{"title", title}, {"oneOf", choices}};
}

Json Nanoseconds() { return {{"type", "integer"}, {"minimum", 0}, {"maximum", 999'999'999}}; }
Json DurationSchema() {
  return Message("duration", {{"sec", Integer()}, {"nsec", Nanoseconds()}}, {"sec", "nsec"});
}

Json Titled(const char* title, Json schema) {
  schema["title"] = title;
  return schema;
}
Json Vector3Schema() { return Titled("foxglove.Vector3", XyzSchema()); }
Json PointsSchema() { return ListOf(Titled("foxglove.Point3", XyzSchema())); }
Json QuaternionSchema() { return Titled("foxglove.Quaternion", Numbers({"x", "y", "z", "w"})); }
Json ColorSchema() { return Titled("foxglove.Color", Numbers({"r", "g", "b", "a"})); }
Json PoseSchema() {
  return Message("foxglove.Pose",
                 {{"position", Vector3Schema()}, {"orientation", QuaternionSchema()}});
}

Json ArrowSchema() {
  return Message("foxglove.ArrowPrimitive", {{"pose", PoseSchema()},
                                             {"shaft_length", Number()},
                                             {"shaft_diameter", Number()},
                                             {"head_length", Number()},
                                             {"head_diameter", Number()},
                                             {"color", ColorSchema()}});
}

Json SolidSchema(const char* title) {
  return Message(title,
                 {{"pose", PoseSchema()}, {"size", Vector3Schema()}, {"color", ColorSchema()}});
}

Json CylinderSchema() {
  return Message("foxglove.CylinderPrimitive", {{"pose", PoseSchema()},
                                                {"size", Vector3Schema()},
                                                {"bottom_scale", Number()},
                                                {"top_scale", Number()},
                                                {"color", ColorSchema()}});
}

Json LineSchema() {
  return Message(
      "foxglove.LinePrimitive",
      {{"type", Enumeration("foxglove.LineType", {"LINE_STRIP", "LINE_LOOP", "LINE_LIST"})},
       {"pose", PoseSchema()},
       {"thickness", Number()},
       {"scale_invariant", Truth()},
       {"points", PointsSchema()},
       {"color", ColorSchema()},
       {"colors", ListOf(ColorSchema())},
       {"indices", ListOf(Unsigned())}});
}

Json TrianglesSchema() {
  return Message("foxglove.TriangleListPrimitive", {{"pose", PoseSchema()},
                                                    {"points", PointsSchema()},
                                                    {"color", ColorSchema()},
                                                    {"colors", ListOf(ColorSchema())},
                                                    {"indices", ListOf(Unsigned())}});
}

Json TextPrimitiveSchema() {
  return Message("foxglove.TextPrimitive", {{"pose", PoseSchema()},
                                            {"billboard", Truth()},
                                            {"font_size", Number()},
                                            {"scale_invariant", Truth()},
                                            {"color", ColorSchema()},
                                            {"text", Text()}});
}

Json ModelSchema() {
  return Message("foxglove.ModelPrimitive",
                 {{"pose", PoseSchema()},
                  {"scale", Vector3Schema()},
                  {"color", ColorSchema()},
                  {"override_color", Truth()},
                  {"url", Text()},
                  {"media_type", Text()},
                  {"data", {{"type", "string"}, {"contentEncoding", "base64"}}}});
}

Json EntitySchema() {
  return Message(
      "foxglove.SceneEntity",
      {{"timestamp", TimeSchema()},
       {"frame_id", Text()},
       {"id", Text()},
       {"lifetime", DurationSchema()},
       {"frame_locked", Truth()},
       {"metadata", ListOf(Message("foxglove.KeyValuePair", {{"key", Text()}, {"value", Text()}}))},
       {"arrows", ListOf(ArrowSchema())},
       {"cubes", ListOf(SolidSchema("foxglove.CubePrimitive"))},
       {"spheres", ListOf(SolidSchema("foxglove.SpherePrimitive"))},
       {"cylinders", ListOf(CylinderSchema())},
       {"lines", ListOf(LineSchema())},
       {"triangles", ListOf(TrianglesSchema())},
       {"texts", ListOf(TextPrimitiveSchema())},
       {"models", ListOf(ModelSchema())}});
}

Json DeletionSchema() {
  return Message("foxglove.SceneEntityDeletion",
                 {{"timestamp", TimeSchema()},
                  {"type", Enumeration("foxglove.SceneEntityDeletionType", {"MATCHING_ID", "ALL"})},
                  {"id", Text()}});
}

}  // namespace

Json Number() { return {{"type", "number"}}; }
Json Integer() { return {{"type", "integer"}}; }
Json Text() { return {{"type", "string"}}; }
Json ListOf(const Json& items) { return {{"type", "array"}, {"items", items}}; }

Json Object(Fields fields) {
  Json properties = Json::object(), required = Json::array();
  for (const auto& [name, schema] : fields) {
    properties[name] = schema;
    required.push_back(name);
  }
  return {{"type", "object"}, {"properties", properties}, {"required", required}};
}

Json Numbers(std::initializer_list<const char*> names) {
  Json properties = Json::object(), required = Json::array();
  for (const char* name : names) {
    properties[name] = Number();
    required.push_back(name);
  }
  return {{"type", "object"}, {"properties", properties}, {"required", required}};
}

Json Message(const char* title, Fields fields, std::initializer_list<const char*> optional) {
  Json schema = Titled(title, Object(fields));
  Json& required = schema["required"];
  for (const char* name : optional)
    required.erase(std::remove(required.begin(), required.end(), Json(name)), required.end());
  if (required.empty()) schema.erase("required");
  return schema;
}

Json TimeSchema() {
  return Message("time", {{"sec", Unsigned()}, {"nsec", Nanoseconds()}}, {"sec", "nsec"});
}
Json XyzSchema() { return Numbers({"x", "y", "z"}); }

Json FrameTransformsSchema() {
  const Json transform = Message("foxglove.FrameTransform", {{"timestamp", TimeSchema()},
                                                             {"parent_frame_id", Text()},
                                                             {"child_frame_id", Text()},
                                                             {"translation", Vector3Schema()},
                                                             {"rotation", QuaternionSchema()}});
  return Message("foxglove.FrameTransforms", {{"transforms", ListOf(transform)}});
}

Json SceneUpdateSchema() {
  return Message("foxglove.SceneUpdate",
                 {{"deletions", ListOf(DeletionSchema())}, {"entities", ListOf(EntitySchema())}});
}

Json JointStatesSchema() {
  const Json joint = Message("foxglove.JointState",
                             {{"name", Text()},
                              {"position", Number()},
                              {"velocity", Number()},
                              {"acceleration", Number()},
                              {"effort", Number()}},
                             {"position", "velocity", "acceleration", "effort"});
  return Message("foxglove.JointStates", {{"timestamp", TimeSchema()}, {"joints", ListOf(joint)}});
}

}  // namespace predictor::foxglove
