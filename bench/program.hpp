#pragma once

namespace frontlux::bench {

/// What a benchmark's `main` does: runs it, and tells on stderr what it throws.
/// @param name  of the program
/// @return what `run` returns, or 2 if it throws
int run_program(const char* name, int (*run)(int argc, char** argv), int argc, char** argv);

}  // namespace frontlux::bench
