/// @file Messages for exceptions of Ice.
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

/// A proxy in its shortest form, "cameraA:tcp -h 127.0.0.1 -p 9999", without the options that Ice adds.
std::string proxyText(const Ice::ObjectPrx& proxy);

/// A text of Ice without default options of proxies and endpoints.
std::string withoutUsualOptions(std::string text);

}  // namespace vismem
