/// @file The includes in the text of an SDF file, and the models that are built in. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vismem {

/// Replaces the includes of Gazebo's ground plane and sun by built-in ones, because they ship with Gazebo,
/// not with the worlds. The include's name and pose stay.
std::string withBuiltInModels(const std::string& xml);

/// Whether a uri means one of these two.
bool isBuiltInModel(const std::string& uri);

/// The uris of the `<include>` elements of a text, in their order.
std::vector<std::string> includedUris(const std::string& xml);

}  // namespace vismem
