// Contact and attachments of one body, behind one interface for both precisions.
#pragma once

#include <corotet/detail/contact/attachment.hpp>
#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/contact/contact_points.hpp>
#include <corotet/detail/contact/contacts.hpp>
#include <corotet/detail/contact/obstacles.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/embed/bind.hpp>
#include <corotet/detail/embed/body_point.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <corotet/detail/terms/step_term.hpp>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "simulation.hpp"

namespace corotet::program {

/// The terms of a body's steps: its contact with obstacles, if it has any, then its attachments.
template <class Scalar>
class TypedContactTerms final : public ContactTerms {
 public:
  /// Once; `obstacles` must outlive it.
  void touch(ContactPoints points, Obstacles& obstacles, const ContactOptions& options) {
    contacts_.emplace(std::move(points), obstacles, options);
    all_.insert(all_.begin(), &*contacts_);
  }
  template <class Element>
  void attach(const BodyPoint<Element>& point, const AttachmentOptions& options) {
    all_.push_back(&attachments_.emplace_back(point, options));
  }

  [[nodiscard]] Terms<Scalar> terms() const { return Terms<Scalar>(std::span<StepTerm<Scalar>* const>(all_)); }

  [[nodiscard]] Index contact_points() const override { return contacts_ ? contacts_->points().size() : 0; }
  [[nodiscard]] ContactReport contact_report() const override {
    return contacts_ ? contacts_->report() : ContactReport();
  }
  void lead_attachment(Index i, const Vec3<double>& target, const Vec3<double>& velocity) override {
    attachments_[at(i)].set_target(target, velocity);
  }
  [[nodiscard]] Vec3<double> attachment_force(Index i) const override { return attachments_[at(i)].force(); }

 private:
  std::optional<Contacts<Scalar>> contacts_;
  std::deque<Attachment<Scalar>> attachments_;  // which stay where they are
  std::vector<StepTerm<Scalar>*> all_;
};

/// The points of a mesh at rest that are nearest to `points`, which are in the world, m.
template <class Scalar, class Element>
std::vector<BodyPoint<Element>> nearest_body_points(const TetMesh<Scalar, Element>& mesh, const Field<double>& points) {
  const auto tree = corotet::detail::element_tree(mesh);
  const double rounding = corotet::detail::position_rounding<Scalar>(tree.bounds());
  std::vector<BodyPoint<Element>> nearest;
  for (const Vec3<double>& point : points) {
    const auto bound = corotet::detail::bind_point(mesh, tree, rounding, point - mesh.origin());
    const auto& vertices = mesh.element(bound.element);
    nearest.push_back({vertices, corotet::detail::extended_weights<Element>(bound.xi, Vec3<double>::Zero())});
  }
  return nearest;
}

}  // namespace corotet::program
