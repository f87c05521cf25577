#include "assessment/output_picture.h"

#include <algorithm>
#include <cmath>

#include "assessment/output.h"
#include "core/format.h"
#include "core/person_state.h"
#include "core/text.h"
#include "report/page.h"

namespace predictor::assessment {
namespace {

using person::Skeleton;
using person::SkeletonSide;

// A view of frame S, given by the directions that point to the right in the picture and away from
// the observer.
struct View {
  const char* name;
  Vector3 right, away;
  double left_edge, right_edge;  // [m]
};
// The picture shows the body from the person's right side and from the front.
const View kSide = {"from the side", Vector3::UnitX(), Vector3::UnitY(), -0.6, 0.95};
const View kFront = {"from the front", Vector3::UnitY(), -Vector3::UnitX(), -0.72, 0.72};

constexpr double kScale = 170;   // scale of a picture [px/m]
constexpr double kAbove = 0.1;   // upper edge above the head [m]
constexpr double kBottom = 0.1;  // lower edge below the ground [m]
constexpr const char* kNotJudged = "var(--grid)";

// Rough widths of the parts of the body [m] (design choice).
namespace breadth {
constexpr double kThigh = 0.13, kShank = 0.09, kFoot = 0.06, kUpperArm = 0.085, kForearm = 0.065,
                 kHand = 0.05, kTrunk = 0.15, kNeck = 0.09, kHead = 0.2;
}  // namespace breadth

class Drawing {
 public:
  // `top` is the person's height [m].
  Drawing(const View& view, double height, double scale = kScale)
      : view_(view), top_(height + kAbove), scale_(scale) {}

  double X(const Vector3& p) const { return scale_ * (view_.right.dot(p) - view_.left_edge); }
  double Y(const Vector3& p) const { return scale_ * (top_ - p.z()); }

  void Line(const Vector3& from, const Vector3& to, const char* attributes) {
    Append(&svg_, "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" %s/>", X(from), Y(from),
           X(to), Y(to), attributes);
  }
  // Draws a body part with round ends and an outline.
  void Limb(const Vector3& from, const Vector3& to, double breadth, const std::string& color) {
    const double width = scale_ * breadth;
    Line(from, to, Formatted("class=\"rim\" stroke-width=\"%.1f\"", width + 2).c_str());
    Line(from, to, Formatted("stroke=\"%s\" stroke-width=\"%.1f\"", color.c_str(), width).c_str());
  }
  // Draws a closed polygon with an outline.
  void Block(const std::vector<Vector3>& corners, double breadth, const std::string& color) {
    std::string points;
    for (const Vector3& p : corners) Append(&points, "%.1f,%.1f ", X(p), Y(p));
    const double width = scale_ * breadth;
    Append(&svg_, "<polygon points=\"%s\" class=\"rim\" stroke-width=\"%.1f\"/>", points.c_str(),
           width + 2);
    Append(&svg_, "<polygon points=\"%s\" fill=\"%s\" stroke=\"%s\" stroke-width=\"%.1f\"/>",
           points.c_str(), color.c_str(), color.c_str(), width);
  }
  void Circle(const Vector3& at, double diameter, const char* attributes) {
    Append(&svg_, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" %s/>", X(at), Y(at),
           scale_ * diameter / 2, attributes);
  }
  void Text(double x, double y, const char* anchor, const std::string& text) {
    Append(&svg_, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>", x, y, anchor,
           EscapeMarkup(text).c_str());
  }
  void Ground() {
    const double y = scale_ * top_;
    Append(&svg_, "<line class=\"ground\" x1=\"0\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>", y,
           Width(), y);
  }
  double Width() const { return scale_ * (view_.right_edge - view_.left_edge); }

  std::string Finish(const std::string& words, const std::string& caption) const {
    return Formatted(
               "<figure class=\"body\"><svg viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" role=\"img\" "
               "aria-label=\"%s\">",
               Width(), scale_ * (top_ + kBottom), Width(), EscapeMarkup(words).c_str()) +
           svg_ + "</svg><p>" + EscapeMarkup(caption) + "</p></figure>\n";
  }
  const View& view() const { return view_; }

 private:
  const View& view_;
  double top_, scale_;
  std::string svg_;
};

// Colours of the parts of a picture. An arm without a handle was not judged.
struct Colors {
  std::string trunk;
  std::array<std::string, kHands> upper_arm, forearm;
};

bool Judged(const Assessment& a, std::size_t part) {
  const int hand = KindOf(static_cast<BodyPart>(part)).hand;
  return hand < 0 || a.hands[static_cast<std::size_t>(hand)];
}

// An unknown load is not judged.
std::string ColorOf(double load) { return std::isfinite(load) ? LoadColor(load) : kNotJudged; }

Colors ColorsOf(const Assessment& a, const PartLoads& loads) {
  const auto color = [&](BodyPart part) {
    const auto k = static_cast<std::size_t>(part);
    return Judged(a, k) ? ColorOf(loads[k]) : kNotJudged;
  };
  return {color(BodyPart::kLowerBack),
          {color(BodyPart::kLeftShoulder), color(BodyPart::kRightShoulder)},
          {color(BodyPart::kLeftElbow), color(BodyPart::kRightElbow)}};
}

void DrawLeg(const SkeletonSide& side, Drawing* d) {
  d->Limb(side.hip, side.knee, breadth::kThigh, kNotJudged);
  d->Limb(side.knee, side.ankle, breadth::kShank, kNotJudged);
  const Vector3 up(0, 0, breadth::kFoot / 2);
  d->Limb(side.heel + up, side.toes + up, breadth::kFoot, kNotJudged);
}

void DrawArm(const SkeletonSide& side, const std::string& upper, const std::string& fore,
             Drawing* d) {
  d->Limb(side.wrist, side.knuckles, breadth::kHand, kNotJudged);
  d->Limb(side.shoulder, side.elbow, breadth::kUpperArm, upper);
  d->Limb(side.elbow, side.wrist, breadth::kForearm, fore);
}

void DrawTrunk(const Skeleton& s, const std::string& color, Drawing* d) {
  d->Limb(s.neck, s.head, breadth::kNeck, kNotJudged);
  // The corners are moved inwards, so that the outline passes through the joints.
  const auto inside = [&](const Vector3& p, const Vector3& middle) {
    return Vector3(p +
                   (middle - p).normalized() * std::min(breadth::kTrunk / 3, (middle - p).norm()));
  };
  const Vector3 shoulders = (s.sides[0].shoulder + s.sides[1].shoulder) / 2;
  d->Block({inside(s.sides[0].shoulder, shoulders), inside(s.sides[1].shoulder, shoulders),
            inside(s.sides[1].hip, s.pelvis), inside(s.sides[0].hip, s.pelvis)},
           breadth::kTrunk, color);
  const Vector3 nose = s.head + 0.55 * breadth::kHead * s.face;
  d->Circle(nose, 0.05, "class=\"skin\"");
  d->Circle(s.head, breadth::kHead, "class=\"skin\"");
}

void DrawBody(const Skeleton& s, const Colors& colors, Drawing* d) {
  // Draws the far side of the body first. The far side is the left side in the view from the right.
  const std::size_t near = d->view().away.y() > 0 ? 1 : 0, far = 1 - near;
  const bool from_front = d->view().away.x() < 0;
  DrawLeg(s.sides[far], d);
  if (from_front)
    DrawLeg(s.sides[near], d);
  else
    DrawArm(s.sides[far], colors.upper_arm[far], colors.forearm[far], d);
  DrawTrunk(s, colors.trunk, d);
  if (from_front)
    DrawArm(s.sides[far], colors.upper_arm[far], colors.forearm[far], d);
  else
    DrawLeg(s.sides[near], d);
  DrawArm(s.sides[near], colors.upper_arm[near], colors.forearm[near], d);
}

// Draws the joints of a possible person as thin lines.
void DrawThin(const Skeleton& s, Drawing* d) {
  constexpr const char* kThin = "class=\"possible\"";
  d->Line(s.pelvis, s.lower_back, kThin);
  d->Line(s.lower_back, s.neck, kThin);
  d->Line(s.neck, s.head, kThin);
  for (const SkeletonSide& side : s.sides) {
    const Vector3 joints[] = {side.ankle, side.knee, side.hip, s.pelvis};
    const Vector3 arm[] = {s.neck, side.shoulder, side.elbow, side.wrist, side.knuckles};
    for (std::size_t k = 0; k + 1 < std::size(joints); ++k)
      d->Line(joints[k], joints[k + 1], kThin);
    for (std::size_t k = 0; k + 1 < std::size(arm); ++k) d->Line(arm[k], arm[k + 1], kThin);
  }
}

// Draws the forces of the hands on the handles as arrows.
void DrawForces(const BodyPicture& picture, Drawing* d) {
  constexpr double kLength = 0.3, kMinForce = 1;  // length of the largest arrow [m]; smallest force
                                                  // with an arrow [N]
  double most = 0;
  for (const Vector3& force : picture.force) most = std::max(most, force.norm());
  for (std::size_t h = 0; h < kHands; ++h) {
    const Vector3& force = picture.force[h];
    if (force.norm() < kMinForce) continue;
    const Vector3 from = picture.body.sides[h].knuckles;
    const Vector3 to = from + force * (kLength / most);
    d->Line(from, to, "class=\"force\" marker-end=\"url(#arrow-head)\"");
  }
}

std::string WholePercent(double share) {
  return std::isfinite(share) ? Formatted("%.0f %%", 100 * share) : "–";
}

// Writes the loads next to the body parts in the front view.
void DrawWords(const Assessment& a, const BodyPicture& picture, Drawing* d) {
  const auto beside = [&](const Vector3& from, const Vector3& to, std::size_t hand, double least) {
    const double sign = hand == 0 ? 1 : -1;  // the person's left is on the right
    const Vector3 middle = (from + to) / 2;
    return std::pair(d->X(middle) + sign * 0.1 * kScale, std::max(d->Y(middle) + 4, least));
  };
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    if (!a.hands[hand]) continue;
    const SkeletonSide& side = picture.body.sides[hand];
    const char* anchor = hand == 0 ? "start" : "end";
    const auto [x, y] = beside(side.shoulder, side.elbow, hand, 0);
    d->Text(x, y, anchor, WholePercent(picture.loads[1 + hand]));
    const auto [u, v] = beside(side.elbow, side.wrist, hand, y + 15);
    d->Text(std::abs(u - d->Width() / 2) > std::abs(x - d->Width() / 2) ? u : x, v, anchor,
            WholePercent(picture.loads[3 + hand]));
  }
  const Skeleton& s = picture.body;
  d->Text(d->X(s.lower_back), d->Y(s.lower_back), "middle", WholePercent(picture.loads[0]));
}

std::string PictureSvg(const Assessment& a, const BodyPicture& picture, const View& view) {
  Drawing d(view, a.setup.body.height);
  d.Ground();
  DrawBody(picture.body, ColorsOf(a, picture.loads), &d);
  for (const Skeleton& possible : picture.possible) DrawThin(possible, &d);
  DrawForces(picture, &d);
  if (&view == &kFront) DrawWords(a, picture, &d);
  return d.Finish(Formatted("The body %s at %.1f s", view.name, picture.time), view.name);
}

std::string SmallSvg(const Assessment& a, const BodyPicture& picture) {
  Drawing d(kSide, a.setup.body.height, kScale / 2);
  d.Ground();
  DrawBody(picture.body, ColorsOf(a, picture.loads), &d);
  return d.Finish(Formatted("The body from the side at %.1f s", picture.time),
                  Formatted("%.1f s", picture.time));
}

std::string LoadTable(const Assessment& a) {
  std::vector<std::vector<std::string>> rows = {{"Part", "Load", "90 %"}};
  for (std::size_t part = 0; part < kBodyParts; ++part) {
    if (!Judged(a, part)) continue;
    const PartKind& kind = KindOf(static_cast<BodyPart>(part));
    const auto& interval = a.worst.intervals[part];
    rows.push_back(
        {Formatted("<i class=\"patch\" style=\"background: %s\"></i>%s",
                   ColorOf(a.worst.loads[part]).c_str(), kind.name),
         WholePercent(a.worst.loads[part]),
         interval ? WholePercent(interval->low) + " … " + WholePercent(interval->high) : "–"});
  }
  return HtmlTable(rows);
}

std::string ColorScale() {
  return Formatted(
      "<p class=\"scale\">0 %% <i style=\"background: linear-gradient(to right, %s, %s, %s)\"></i> "
      "100 %% and more <i class=\"patch\" style=\"background: %s\"></i>not judged</p>\n",
      LoadColor(0).c_str(), LoadColor(0.5).c_str(), LoadColor(1).c_str(), kNotJudged);
}

}  // namespace

std::string LoadColor(double share) {
  constexpr std::array<std::array<double, 3>, 3> kStops = {
      {{0x8f, 0xd3, 0xb6}, {0xf2, 0xa9, 0x1e}, {0x9c, 0x0f, 0x2c}}};
  const double x = 2 * std::clamp(share, 0.0, 1.0);
  const std::size_t low = x < 1 ? 0 : 1;
  std::string color = "#";
  for (std::size_t k = 0; k < 3; ++k)
    Append(&color, "%02x",
           static_cast<unsigned>(std::lround(
               std::lerp(kStops[low][k], kStops[low + 1][k], x - static_cast<double>(low)))));
  return color;
}

std::string PicturesHtml(const Assessment& a) {
  std::string html =
      "<svg width=\"0\" height=\"0\" class=\"defs\"><defs><marker id=\"arrow-head\" "
      "viewBox=\"0 0 8 8\" refX=\"4\" refY=\"4\" markerWidth=\"3.5\" markerHeight=\"3.5\" "
      "orient=\"auto\"><path d=\"M0 0 8 4 0 8z\"/></marker></defs></svg>\n"
      "<div class=\"bodies\">" +
      PictureSvg(a, a.worst, kSide) + PictureSvg(a, a.worst, kFront) + "<div>" + LoadTable(a) +
      ColorScale() + "</div></div>\n";
  html +=
      "<p class=\"caption\">" +
      EscapeMarkup(Formatted(
          "The picture shows the moment of the highest load, %.1f s after the start (modelled "
          "from the measured handles and forces). The loads are the compression of the lower "
          "back as a share of NIOSH's limit (3.4 kN), and the torques of shoulders and elbows "
          "as shares of the mean strength for the person's sex. %s Arrows: the force of the hands "
          "on the handles.%s %s",
          a.worst.time, kCompressionCaveat,
          a.worst.possible.empty() ? ""
                                   : " The thin lines show other possible postures and bodies, "
                                     "because the handles do not determine the posture.",
          OperatorSentence(a).c_str())) +
      "</p>\n<div class=\"bodies\">";
  for (const BodyPicture& picture : a.pictures) html += SmallSvg(a, picture);
  return html + "</div>\n";
}

}  // namespace predictor::assessment
