#define COROTET_COMPILING_BODY float, Tet10
#include "everything.hpp"
