#define COROTET_COMPILING_SOLVER float
#include "everything.hpp"
