#include "contact_detector.h"

#include <ode/ode.h>

#include <array>
#include <dart/collision/CollisionFilter.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <dart/collision/ode/OdeCollisionDetector.hpp>
#include <dart/collision/ode/OdeCollisionGroup.hpp>
#include <dart/collision/ode/OdeCollisionObject.hpp>
#include <dart/dynamics/ShapeNode.hpp>

namespace predictor::dart_engine {
namespace {

using dart::collision::CollisionObject;
using dart::collision::CollisionOption;
using dart::collision::CollisionResult;
using dart::collision::OdeCollisionDetector;
using dart::collision::OdeCollisionGroup;
using dart::collision::OdeCollisionObject;

constexpr int kMaxPoints = 32;  // of a pair of shapes

class Group final : public OdeCollisionGroup {
 public:
  using OdeCollisionGroup::getOdeSpaceId;
  using OdeCollisionGroup::OdeCollisionGroup;
  using OdeCollisionGroup::updateEngineData;
};

struct Search {
  const CollisionOption& option;
  CollisionResult* result;
  bool found = false;
};

Eigen::Vector3d VectorOf(const dReal* xyz) { return {xyz[0], xyz[1], xyz[2]}; }

// Returns whether a shape may have contacts. DART's own filter checks this only for bodies, not for
// their shapes.
bool IsCollidable(const CollisionObject& object) {
  return object.getShapeFrame()->asShapeNode()->getCollisionAspect()->isCollidable();
}

void TestPair(void* data, dGeomID first, dGeomID second) {
  auto* search = static_cast<Search*>(data);
  auto* a = static_cast<OdeCollisionObject*>(dGeomGetData(first));
  auto* b = static_cast<OdeCollisionObject*>(dGeomGetData(second));
  const auto& filter = search->option.collisionFilter;
  if (!IsCollidable(*a) || !IsCollidable(*b) || (filter && filter->ignoresCollision(a, b))) return;
  std::array<dContactGeom, kMaxPoints> points;
  const int count = dCollide(first, second, kMaxPoints, points.data(), sizeof(dContactGeom));
  search->found |= count > 0;
  if (search->result == nullptr) return;
  for (int i = 0; i < count; ++i) {
    if (search->result->getNumContacts() >= search->option.maxNumContacts) return;
    const dContactGeom& from = points[static_cast<std::size_t>(i)];
    dart::collision::Contact contact;
    contact.collisionObject1 = a;
    contact.collisionObject2 = b;
    contact.point = VectorOf(from.pos);
    contact.normal = VectorOf(from.normal);
    contact.penetrationDepth = from.depth;
    search->result->addContact(contact);
  }
}

class ContactDetector final : public OdeCollisionDetector {
 public:
  ContactDetector() = default;

  std::unique_ptr<dart::collision::CollisionGroup> createCollisionGroup() override {
    return std::make_unique<Group>(shared_from_this());
  }
  bool collide(dart::collision::CollisionGroup* group, const CollisionOption& option,
               CollisionResult* result) override {
    if (result != nullptr) result->clear();
    auto* own = static_cast<Group*>(group);
    own->updateEngineData();
    Search search{option, result};
    dSpaceCollide(own->getOdeSpaceId(), &search, TestPair);
    return search.found;
  }
};

}  // namespace

std::shared_ptr<dart::collision::CollisionDetector> MakeContactDetector() {
  return std::make_shared<ContactDetector>();
}

}  // namespace predictor::dart_engine
