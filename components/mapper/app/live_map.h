/// @file The client of a running mapper. See B6.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace vismem {

/// Has a running mapper make a map of the drive so far, shows the progress, and waits for it.
/// @param proxy  of the mapper, such as "Mapper:tcp -h 127.0.0.1 -p 9974".
/// @param name   of the files; empty: as the mapper is configured.
/// @return the summary, with a list `problems` where there is no usable map.
/// @throws std::runtime_error with the reason when the mapper refuses or does not answer.
nlohmann::json makeLiveMap(const std::string& proxy, const std::string& name);

}  // namespace vismem
