// Which instances of the library's classes corotet::compiled holds.
#pragma once

#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/version.hpp>

// A program that links corotet::compiled has COROTET_COMPILED defined: it then takes the usual instances from there,
// with optimisation whatever the program's own settings are, and compiles the unusual ones itself. Without, everything
// is compiled where it is used. The sources of the library define one of the other two, which name what they compile.

namespace corotet::inline v0_1 {

struct Tet4;
struct Tet10;

}  // namespace corotet::inline v0_1

// NOLINTBEGIN(bugprone-macro-parentheses): names of templates
// For a class with a scalar, for one with a scalar and an element, and for one with a body of these. Parameters that
// follow have their defaults.
#define COROTET_EXTERN_OF_SCALAR(Class) \
  extern template class Class<float>;   \
  extern template class Class<double>;
#if defined(COROTET_COMPILED)
#define COROTET_INSTANCES_OF_SCALAR(Class) COROTET_EXTERN_OF_SCALAR(Class)
#define COROTET_INSTANCES_OF_ELEMENT(Class)  \
  extern template class Class<float, Tet4>;  \
  extern template class Class<float, Tet10>; \
  extern template class Class<double, Tet4>; \
  extern template class Class<double, Tet10>;
#define COROTET_INSTANCES_OF_BODY(Class)               \
  extern template class Class<SoftBody<float, Tet4>>;  \
  extern template class Class<SoftBody<float, Tet10>>; \
  extern template class Class<SoftBody<double, Tet4>>; \
  extern template class Class<SoftBody<double, Tet10>>;
#elif defined(COROTET_COMPILING_BODY)
#define COROTET_INSTANCES_OF_SCALAR(Class) COROTET_EXTERN_OF_SCALAR(Class)
#define COROTET_INSTANCES_OF_ELEMENT(Class) template class Class<COROTET_COMPILING_BODY>;
#define COROTET_INSTANCES_OF_BODY(Class) template class Class<SoftBody<COROTET_COMPILING_BODY>>;
#else
#if defined(COROTET_COMPILING_SOLVER)
#define COROTET_INSTANCES_OF_SCALAR(Class) template class Class<COROTET_COMPILING_SOLVER>;
#else
#define COROTET_INSTANCES_OF_SCALAR(Class)
#endif
#define COROTET_INSTANCES_OF_ELEMENT(Class)
#define COROTET_INSTANCES_OF_BODY(Class)
#endif
// NOLINTEND(bugprone-macro-parentheses)
