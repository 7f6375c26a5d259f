#define COROTET_COMPILING_SOLVER double
#include "everything.hpp"
