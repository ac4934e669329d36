#include "calibration/core/body/observability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace vismem {
namespace {

/// Information below this, in units of the useful standard deviations, is rounding.
constexpr double kRounding = 1e-9;
/// Share of a parameter in a direction of length 1 from which it is named.
constexpr double kNamedShare = 0.25;

UnknownDirection describe(const Eigen::VectorXd& direction, const std::vector<std::size_t>& parameters,
                          const std::vector<std::string_view>& name) {
  std::vector<std::size_t> order(name.size());
  std::iota(order.begin(), order.end(), 0);
  const auto share = [&](std::size_t i) { return std::abs(direction[static_cast<Eigen::Index>(i)]); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return share(a) > share(b); });
  UnknownDirection unknown;
  for (const std::size_t i : order) {
    if (share(i) < kNamedShare && !unknown.parameters.empty()) break;
    unknown.parameters.push_back(parameters[i]);
    unknown.text += (unknown.text.empty() ? "" : ", ") + std::string(name[i]);
  }
  return unknown;
}

}  // namespace

Observability analyse(const ParameterInformation& information, const std::vector<std::string_view>& name,
                      const std::vector<double>& useful_sigma) {
  const auto n = static_cast<Eigen::Index>(name.size());
  const Eigen::Map<const Eigen::VectorXd> unit(useful_sigma.data(), n);
  const Eigen::MatrixXd scaled = unit.asDiagonal() * information.matrix * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (scaled + scaled.transpose()));
  Observability result;
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(n);
  result.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double value = std::max(eigen.eigenvalues()[k], kRounding);
    const Eigen::VectorXd direction = eigen.eigenvectors().col(k);
    variance += direction.cwiseAbs2() / value;
    result.covariance += direction * direction.transpose() / value;
    if (value < 1.0) result.unknown.push_back(describe(direction, information.parameters, name));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool known = variance[i] <= 1.0;
    result.sigma.push_back(known ? std::optional(std::sqrt(variance[i]) * unit[i]) : std::nullopt);
  }
  result.covariance = unit.asDiagonal() * result.covariance * unit.asDiagonal();
  return result;
}

}  // namespace vismem
