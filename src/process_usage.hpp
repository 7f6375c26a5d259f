// What this process has used of the machine.
#pragma once

namespace corotet::program {

/// Processor time of all threads since the process began, s.
[[nodiscard]] double cpu_seconds();

/// The most memory that was resident so far, MiB; 0 where the system does not tell.
[[nodiscard]] double peak_rss_mb();

/// Memory resident now, MiB, after what was freed has gone back to the system; 0 where the system does not tell.
[[nodiscard]] double current_rss_mb();

/// Makes `peak_rss_mb` start again from now, where the system can (Linux).
void reset_peak_rss();

}  // namespace corotet::program
