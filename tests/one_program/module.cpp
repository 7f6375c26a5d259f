// A shared library that keeps its names to itself, and so numbers states for itself.
#include <corotet/detail/core/revision.hpp>

__attribute__((visibility("default"))) corotet::Revision MODULE_REVISION();
corotet::Revision MODULE_REVISION() { return corotet::detail::new_revision(); }
