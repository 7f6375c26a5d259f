"""What a user's file costs to compile, in units of `#include <Eigen/Dense>` alone on the same machine.

compile_time.py COMPILER INCLUDE_DIR EIGEN_DIR HELLO: processor seconds at -O2 over those of the unit, compiled just
before, the least of several tries; and the memory of the largest. Fails above the bounds. Processor time grows when the
machine is busy with other things, the unit's with it: where a ratio is too high it is tried again before it counts.
"""
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

TRIES = 6
MEGABYTES_OF_HELLO = 600


def cost(command):
    """User and system seconds of a command, and its peak memory in MB."""
    pid = os.spawnvp(os.P_NOWAIT, command[0], command)
    _, status, usage = os.wait4(pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit("this did not compile: " + " ".join(command))
    return usage.ru_utime + usage.ru_stime


def peak_megabytes():
    """Of any child so far: the compiler proper is a grandchild, which the kernel counts with its parent."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def main():
    compiler, include, eigen, hello = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        def source(name, text):
            path = Path(folder) / name
            path.write_text(text)
            return str(path)

        flags = [compiler, "-std=c++20", "-O2", "-I", include, "-isystem", eigen, "-c", "-o", os.devnull]
        unit = flags + [source("unit.cpp", "#include <Eigen/Dense>\n")]
        cases = {  # command, at most as many units
            "corotet.hpp": (flags + [source("all.cpp", "#include <corotet/corotet.hpp>\n")], 2.5),
            "hello.cpp with corotet::compiled": (flags + ["-DCOROTET_COMPILED", hello], 2.5),
            "hello.cpp, headers alone": (flags + [hello], 8),
        }
        failed = False
        for name, (command, bound) in cases.items():
            ratio = float("inf")
            for _ in range(TRIES):
                one = cost(unit)
                seconds = cost(command)
                ratio = min(ratio, seconds / one)
                if ratio <= bound:
                    break
            failed |= ratio > bound
            print(f"{name}: {ratio:.2f} times <Eigen/Dense> ({one:.2f} s), at most {bound}")
        memory = peak_megabytes()
        print(f"memory: {memory:.0f} MB, at most {MEGABYTES_OF_HELLO}")
        return 1 if failed or memory > MEGABYTES_OF_HELLO else 0


if __name__ == "__main__":
    subprocess.run([sys.argv[1], "--version"], check=True, stdout=subprocess.DEVNULL)
    sys.exit(main())
