/// @file What an exception of Ice means, in words for people.
#pragma once

#include <exception>
#include <string>

namespace vismem {

/// "connection refused", "no answer in time", "no object cameraA there", or the message of any other
/// exception. Thread-safe.
std::string describeFailure(const std::exception& failure);

}  // namespace vismem
