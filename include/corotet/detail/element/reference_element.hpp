// What a reference element must offer; Tet4 and Tet10 are the two that the library knows.
//
// A reader's own element needs ReferenceElement to carry a mesh, a body and its steps. What asks for the corners, edges
// or faces of a tetrahedron (boundaries, embedded surfaces, quality, files) needs TetrahedralElement.
//
// The reference tetrahedron has its corners at (0,0,0), (1,0,0), (0,1,0), (0,0,1) and volume 1/6. Natural coordinates
// xi = (xi1, xi2, xi3) are the barycentric coordinates of corners 1, 2 and 3.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

namespace corotet::inline v0_1 {

/// (xi1, xi2, xi3), or a gradient with respect to them. Plain numbers, so that tables are made by the compiler.
using NaturalCoordinates = std::array<double, 3>;

/// A quadrature point: natural coordinates and weight. The weights of a rule sum to the volume of the reference
/// element, 1/6 for a tetrahedron.
struct QuadraturePoint {
  NaturalCoordinates xi;  ///< natural coordinates
  double weight;          ///< its share of the reference element's volume
};

/// The corners that bound an edge.
struct ElementEdge {
  std::size_t a;  ///< number of one corner
  std::size_t b;  ///< number of the other
};

/// The six edges of a tetrahedron, in the order in which Tet10 numbers its mid-edge nodes 4 ... 9.
inline constexpr std::array<ElementEdge, 6> tet_edges{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// The four faces as corner triples, each counter-clockwise seen from outside; face f lies opposite corner f.
inline constexpr std::array<std::array<std::size_t, 3>, 4> tet_faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// Laws: shape functions sum to 1, their gradients to 0; shape function a is 1 at node a and 0 at the other nodes;
/// `stiffness_points` integrates the stiffness of an undistorted element exactly, `mass_points` its mass. An element
/// whose Jacobian is negative has a positive one once its node a is what was its node mirrored[a]. All are constants.
template <class E>
concept ReferenceElement = requires(const NaturalCoordinates& xi) {
  requires std::same_as<decltype(E::nodes), const int>;
  { E::shape(xi) } -> std::same_as<std::array<double, E::nodes>>;
  { E::gradient(xi) } -> std::same_as<std::array<NaturalCoordinates, E::nodes>>;
  requires std::same_as<decltype(E::mirrored), const std::array<std::size_t, E::nodes>>;
  E::stiffness_points.size();
  E::mass_points.size();
};

/// A tetrahedron whose first four nodes are the corners above, in their order. `edge_nodes` is the number of its nodes
/// on each edge besides: 0, or 1 for the midpoints of `tet_edges`, which then are the nodes 4 ... 9.
template <class E>
concept TetrahedralElement = ReferenceElement<E> && requires {
  requires std::same_as<decltype(E::edge_nodes), const int>;
  requires E::edge_nodes == 0 || E::edge_nodes == 1;
  requires E::nodes == 4 + 6 * E::edge_nodes;
};

namespace detail {

/// Gradients of the shape functions in natural coordinates at some points: [point][node].
template <ReferenceElement Element, std::size_t points>
[[nodiscard]] constexpr auto gradients_at(const std::array<QuadraturePoint, points>& rule) {
  std::array<std::array<NaturalCoordinates, Element::nodes>, points> table{};
  for (std::size_t q = 0; q < points; ++q) table[q] = Element::gradient(rule[q].xi);
  return table;
}

/// The same at the quadrature points of the stiffness.
template <ReferenceElement Element>
inline constexpr auto natural_gradients = gradients_at<Element>(Element::stiffness_points);

template <ReferenceElement Element>
[[nodiscard]] constexpr bool gradients_are(const std::array<NaturalCoordinates, Element::nodes>& expected) {
  for (const auto& gradients : natural_gradients<Element>)
    if (gradients != expected) return false;
  for (const auto& gradients : gradients_at<Element>(Element::mass_points))
    if (gradients != expected) return false;
  return true;
}

}  // namespace detail

/// Whether the gradients of the shape functions are the same everywhere: then so are the Jacobian and F.
template <ReferenceElement Element>
inline constexpr bool has_constant_gradients = detail::gradients_are<Element>(detail::natural_gradients<Element>[0]);

/// Whether the gradients of the shape functions are (-1, -1, -1) and the three unit vectors: those of the linear
/// tetrahedron, which kernels know by heart.
template <ReferenceElement Element>
inline constexpr bool has_unit_gradients = [] {
  if constexpr (Element::nodes == 4)
    return detail::gradients_are<Element>({{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  else
    return false;
}();

/// The linear tetrahedron: one quadrature point, and faces by which elements are neighbours.
template <class E>
concept LinearTetrahedron = TetrahedralElement<E> && has_unit_gradients<E> && E::stiffness_points.size() == 1;

namespace quadrature {

/// Exact for polynomials of degree 1.
inline constexpr std::array<QuadraturePoint, 1> degree1{{{{0.25, 0.25, 0.25}, 1.0 / 6.0}}};

/// Exact for degree 2; points at (5 -+ sqrt 5)/20 and (5 +- 3 sqrt 5)/20 (Hammer, Marlowe & Stroud 1956).
inline constexpr double degree2_a = 0.13819660112501051518;
inline constexpr double degree2_b = 0.58541019662496845446;
inline constexpr std::array<QuadraturePoint, 4> degree2{{
    {{degree2_a, degree2_a, degree2_a}, 1.0 / 24.0},
    {{degree2_b, degree2_a, degree2_a}, 1.0 / 24.0},
    {{degree2_a, degree2_b, degree2_a}, 1.0 / 24.0},
    {{degree2_a, degree2_a, degree2_b}, 1.0 / 24.0},
}};

namespace detail {

constexpr std::array<QuadraturePoint, 14> make_degree5() {
  // Walkington 2000: two orbits of four points (a,a,a,1-3a) and one of six points (a,a,1/2-a,1/2-a).
  constexpr double a1 = 0.31088591926330060980, w1 = 0.11268792571801585080 / 6.0;
  constexpr double a2 = 0.092735250310891226402, w2 = 0.073493043116361949544 / 6.0;
  constexpr double a3 = 0.045503704125649649492, w3 = 0.042546020777081466438 / 6.0, c3 = 0.5 - a3;
  constexpr double b1 = 1.0 - 3.0 * a1, b2 = 1.0 - 3.0 * a2;
  return {{{{a1, a1, a1}, w1},
           {{b1, a1, a1}, w1},
           {{a1, b1, a1}, w1},
           {{a1, a1, b1}, w1},
           {{a2, a2, a2}, w2},
           {{b2, a2, a2}, w2},
           {{a2, b2, a2}, w2},
           {{a2, a2, b2}, w2},
           {{a3, a3, c3}, w3},
           {{a3, c3, a3}, w3},
           {{c3, a3, a3}, w3},
           {{a3, c3, c3}, w3},
           {{c3, a3, c3}, w3},
           {{c3, c3, a3}, w3}}};
}

}  // namespace detail

/// Exact for degree 5, all weights positive.
inline constexpr std::array<QuadraturePoint, 14> degree5 = detail::make_degree5();

}  // namespace quadrature

}  // namespace corotet::inline v0_1
