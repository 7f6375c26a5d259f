#define COROTET_COMPILING_BODY double, Tet10
#include "everything.hpp"
