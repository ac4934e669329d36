// Failures in words: those of a limit of the process name it.
#include "common/process/ice_failure.h"

#include <Ice/Ice.h>
#include <IceUtil/ThreadException.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <new>
#include <system_error>

namespace vismem {
namespace {

using testing::MatchesRegex;

std::string limitOf(__rlimit_resource resource, rlim_t unit) {
  rlimit limit{};
  getrlimit(resource, &limit);
  return limit.rlim_cur == RLIM_INFINITY ? "unlimited" : std::to_string(limit.rlim_cur / unit);
}

TEST(DescribeFailure, NamesTheLimitThatAProcessMeets) {
  EXPECT_EQ(describeFailure(Ice::SocketException(__FILE__, __LINE__, EMFILE)),
            "Too many open files (ulimit -n is " + limitOf(RLIMIT_NOFILE, 1) + ")");
  EXPECT_EQ(describeFailure(IceUtil::ThreadSyscallException(__FILE__, __LINE__, EAGAIN)),
            "no further thread: Resource temporarily unavailable (ulimit -u is " + limitOf(RLIMIT_NPROC, 1) +
                ", -v is " + limitOf(RLIMIT_AS, 1024) + ")");
  EXPECT_THAT(describeFailure(std::system_error(EAGAIN, std::generic_category(), "thread")),
              MatchesRegex("thread: .* \\(ulimit -u is .*"));
  EXPECT_EQ(describeFailure(std::bad_alloc()),
            "not enough memory (ulimit -v is " + limitOf(RLIMIT_AS, 1024) + ")");
}

TEST(DescribeFailure, LeavesOtherFailuresAsTheyAre) {
  EXPECT_EQ(describeFailure(Ice::SocketException(__FILE__, __LINE__, EADDRINUSE)), "Address already in use");
  EXPECT_EQ(describeFailure(std::runtime_error("no map")), "no map");
}

}  // namespace
}  // namespace vismem
