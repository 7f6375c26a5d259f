// Which instances of the library's classes corotet::compiled holds.
#pragma once

#include <corotet/core/compiler.hpp>

// A program that links corotet::compiled has COROTET_COMPILED defined: it then takes the usual instances from there,
// with optimisation whatever the program's own settings are, and compiles the unusual ones itself. Without, everything
// is compiled where it is used. The library itself is one source that includes the headers and lists the same
// instances.
#if defined(COROTET_COMPILED)
#define COROTET_INSTANCE extern template
#elif defined(COROTET_COMPILING)
#define COROTET_INSTANCE template
#endif

namespace corotet::inline v0_1 {

struct Tet4;
struct Tet10;

}  // namespace corotet::inline v0_1

// For a class with a scalar, with a scalar and an element, and with a body of these. (Parameters that follow have
// their defaults.)
#if defined(COROTET_INSTANCE)
#define COROTET_INSTANCES_OF_SCALAR(Class) \
  COROTET_INSTANCE class Class<float>;     \
  COROTET_INSTANCE class Class<double>;
#define COROTET_INSTANCES_OF_ELEMENT(Class)   \
  COROTET_INSTANCE class Class<float, Tet4>;  \
  COROTET_INSTANCE class Class<float, Tet10>; \
  COROTET_INSTANCE class Class<double, Tet4>; \
  COROTET_INSTANCE class Class<double, Tet10>;
#define COROTET_INSTANCES_OF_BODY(Class)                \
  COROTET_INSTANCE class Class<SoftBody<float, Tet4>>;  \
  COROTET_INSTANCE class Class<SoftBody<float, Tet10>>; \
  COROTET_INSTANCE class Class<SoftBody<double, Tet4>>; \
  COROTET_INSTANCE class Class<SoftBody<double, Tet10>>;
#else
#define COROTET_INSTANCES_OF_SCALAR(Class)
#define COROTET_INSTANCES_OF_ELEMENT(Class)
#define COROTET_INSTANCES_OF_BODY(Class)
#endif
