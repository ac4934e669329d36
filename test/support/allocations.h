/// @file Counts the allocations of a test's program: statically linked code, by `new` and by malloc.
#pragma once

namespace vismem::test {

/// Number of allocations so far, of all threads.
long allocations();

}  // namespace vismem::test
