// The one place where the version is written; CMake reads it from here.
#pragma once

#define COROTET_VERSION_MAJOR 0
#define COROTET_VERSION_MINOR 1
#define COROTET_VERSION_PATCH 0
