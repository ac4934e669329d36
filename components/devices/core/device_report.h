/// @file The list of devices for people and for programs. Pure.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "devices/core/device_list.h"

namespace vismem {

std::string devicesText(const FoundDevices& devices);
nlohmann::json devicesJson(const FoundDevices& devices);

}  // namespace vismem
