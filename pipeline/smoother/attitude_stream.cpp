#include "pipeline/smoother/attitude_stream.hpp"

#include <deque>
#include <utility>

#include "pipeline/estimator/plausibility.hpp"

namespace gimbal {
namespace {

class CausalStream : public AttitudeStream {
 public:
  explicit CausalStream(std::unique_ptr<Estimator> estimator) : estimator_(std::move(estimator)) {}

  void push(const ImuSample& sample) override { ready_.push_back(estimator_->update(sample)); }

  void finish() override {}

  std::optional<Attitude> pop() override {
    if (ready_.empty()) return std::nullopt;
    const Attitude attitude = ready_.front();
    ready_.pop_front();
    return attitude;
  }

  [[nodiscard]] std::string_view suspicion() const override { return {}; }

 private:
  std::unique_ptr<Estimator> estimator_;
  std::deque<Attitude> ready_;
};

class CausalEkfStream final : public CausalStream {
 public:
  explicit CausalEkfStream(std::unique_ptr<AttitudeEkf> ekf, const AttitudeEkf& same)
      : CausalStream(std::move(ekf)), ekf_(same) {}

  [[nodiscard]] std::string_view suspicion() const override {
    return describe(ekf_.plausibility());
  }

 private:
  const AttitudeEkf& ekf_;  ///< the one that the base owns
};

class SmoothedStream final : public AttitudeStream {
 public:
  explicit SmoothedStream(const FixedLagSmootherParameters& parameters) : smoother_(parameters) {}

  void push(const ImuSample& sample) override { smoother_.push(sample); }
  void finish() override { smoother_.finish(); }

  std::optional<Attitude> pop() override {
    const auto estimate = smoother_.pop();
    if (!estimate) return std::nullopt;
    return estimate->attitude;
  }

  [[nodiscard]] std::string_view suspicion() const override {
    return describe(smoother_.filter().plausibility());
  }

 private:
  FixedLagSmoother smoother_;
};

}  // namespace

std::unique_ptr<AttitudeStream> make_causal_stream(std::unique_ptr<Estimator> estimator) {
  return std::make_unique<CausalStream>(std::move(estimator));
}

std::unique_ptr<AttitudeStream> make_causal_stream(const AttitudeEkfParameters& parameters) {
  auto ekf = std::make_unique<AttitudeEkf>(parameters);
  const AttitudeEkf& same = *ekf;
  return std::make_unique<CausalEkfStream>(std::move(ekf), same);
}

std::unique_ptr<AttitudeStream> make_smoothed_stream(const FixedLagSmootherParameters& parameters) {
  return std::make_unique<SmoothedStream>(parameters);
}

}  // namespace gimbal
