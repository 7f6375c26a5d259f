// What this process has used of the machine.
#pragma once

namespace corotet::program {

/// Processor time of all threads since the process began, s.
[[nodiscard]] double cpu_seconds();

/// The most memory that was resident so far, MiB; 0 where the system does not tell.
[[nodiscard]] double peak_rss_mb();

}  // namespace corotet::program
