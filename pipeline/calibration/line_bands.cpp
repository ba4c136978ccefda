#include "pipeline/calibration/line_bands.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numbers>

namespace gimbal {
namespace {

constexpr std::array<int, 1> kFundamental = {1};

/// A constant, then cosine and sine of each harmonic, along the lines.
Eigen::MatrixXd basis(Eigen::Index lines, double bands, std::span<const int> harmonics) {
  const auto count = static_cast<Eigen::Index>(harmonics.size());
  const Eigen::ArrayXd turns = Eigen::ArrayXd::LinSpaced(lines, 0, static_cast<double>(lines - 1)) *
                               (2 * std::numbers::pi * bands / static_cast<double>(lines));
  Eigen::MatrixXd columns(lines, 1 + 2 * count);
  columns.col(0).setOnes();
  for (Eigen::Index i = 0; i < count; ++i) {
    const double harmonic = harmonics[static_cast<std::size_t>(i)];
    columns.col(1 + 2 * i) = (harmonic * turns).cos();
    columns.col(2 + 2 * i) = (harmonic * turns).sin();
  }
  return columns;
}

}  // namespace

LineBands::LineBands(std::span<const LineProfile> profiles) {
  const auto lines = static_cast<Eigen::Index>(profiles.front().light.size());
  changes_.resize(lines, static_cast<Eigen::Index>(profiles.size()));
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    changes_.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::VectorXd>(profiles[i].light.data(), lines);
  }
  const Eigen::VectorXd means = changes_.rowwise().mean().cwiseMax(1e-9);
  changes_ = means.cwiseInverse().asDiagonal() * changes_;
  changes_.rowwise() -= changes_.colwise().mean();
}

double LineBands::contrast() const {
  return std::sqrt(changes_.squaredNorm() / static_cast<double>(changes_.size()));
}

double LineBands::explained(double bands) const {
  const Eigen::MatrixXd columns = basis(lines(), bands, kFundamental);
  const Eigen::MatrixXd products = columns.transpose() * changes_;
  const Eigen::Matrix3d normal = columns.transpose() * columns;
  return products.cwiseProduct(normal.ldlt().solve(products)).sum() / changes_.squaredNorm();
}

Eigen::MatrixXcd LineBands::amplitudes(double bands, std::span<const int> harmonics) const {
  const Eigen::MatrixXd columns = basis(lines(), bands, harmonics);
  const Eigen::MatrixXd found =
      (columns.transpose() * columns).ldlt().solve(columns.transpose() * changes_);
  const auto count = static_cast<Eigen::Index>(harmonics.size());
  Eigen::MatrixXcd amplitudes(count, changes_.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    amplitudes.row(i).real() = found.row(1 + 2 * i);
    amplitudes.row(i).imag() = -found.row(2 + 2 * i);
  }
  return amplitudes;
}

}  // namespace gimbal
