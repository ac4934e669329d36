/// @file Counts the allocations of a test's program: the code that is linked statically, by `new` and by
/// malloc.
#pragma once

namespace vismem::test {

/// So far, of all threads.
long allocations();

}  // namespace vismem::test
