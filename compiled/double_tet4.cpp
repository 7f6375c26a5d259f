#define COROTET_COMPILING_BODY double, Tet4
#include "everything.hpp"
