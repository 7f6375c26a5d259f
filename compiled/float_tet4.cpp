#define COROTET_COMPILING_BODY float, Tet4
#include "everything.hpp"
