/// @file What a least squares knows of its parameters: standard deviations, and combinations that the data do
/// not determine, by name. Pure.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vismem {

/// Information matrix of some parameters, nuisance parameters eliminated (Schur complement).
struct ParameterInformation {
  std::vector<std::size_t> parameters;  ///< rows and columns, as of parameterOf()
  Eigen::MatrixXd matrix;               ///< [1/SI^2]
};

/// A combination of parameters that the data do not determine.
struct UnknownDirection {
  std::vector<std::size_t> parameters;  ///< with a share in it, largest first
  std::string text;                     ///< "unit height, board height"
};

struct Observability {
  /// By row of the information: the standard deviation [SI]; empty: not observable.
  std::vector<std::optional<double>> sigma;
  std::vector<UnknownDirection> unknown;
  /// Covariance [SI^2]; huge along unknown directions.
  Eigen::MatrixXd covariance;
};

/// @param name and useful_sigma by row: a parameter with a larger standard deviation is not observable.
Observability analyse(const ParameterInformation& information, const std::vector<std::string_view>& name,
                      const std::vector<double>& useful_sigma);

}  // namespace vismem
