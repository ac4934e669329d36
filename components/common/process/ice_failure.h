/// @file What an exception of Ice means, in words for people.
#pragma once

#include <exception>
#include <string>

namespace Ice {
class ObjectPrx;
}

namespace vismem {

/// "connection refused", "no answer in time", "no object cameraA there", or the message of any other
/// exception. Thread-safe.
std::string describeFailure(const std::exception& failure);

/// A proxy as a person would write it, "cameraA:tcp -h 127.0.0.1 -p 9999", without what Ice adds of its own.
std::string proxyText(const Ice::ObjectPrx& proxy);

/// A text of Ice without the options that say nothing: defaults of proxies and endpoints.
std::string withoutUsualOptions(std::string text);

}  // namespace vismem
