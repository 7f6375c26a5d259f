// The one place where the version is written; CMake reads it from here. The inline namespace that all is in is named
// after it, so that two versions in one program do not meet.
#pragma once

#define COROTET_VERSION_MAJOR 0
#define COROTET_VERSION_MINOR 1
#define COROTET_VERSION_PATCH 0
