#include "pipeline/smoother/attitude_stream.hpp"

#include <deque>
#include <utility>

#include "pipeline/estimator/plausibility.hpp"

namespace gimbal {
namespace {

template <typename Filter>
class CausalStream final : public AttitudeStream {
 public:
  explicit CausalStream(std::unique_ptr<Filter> filter) : filter_(std::move(filter)) {}

  void push(const ImuSample& sample) override { ready_.push_back(filter_->update(sample)); }

  void finish() override {}

  std::optional<Attitude> pop() override {
    if (ready_.empty()) return std::nullopt;
    const Attitude attitude = ready_.front();
    ready_.pop_front();
    return attitude;
  }

  [[nodiscard]] std::string_view suspicion() const override {
    if constexpr (requires { filter_->plausibility(); }) {
      return describe(filter_->plausibility());
    }
    return {};
  }

 private:
  std::unique_ptr<Filter> filter_;
  std::deque<Attitude> ready_;
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
  return std::make_unique<CausalStream<Estimator>>(std::move(estimator));
}

std::unique_ptr<AttitudeStream> make_causal_stream(const AttitudeEkfParameters& parameters) {
  return std::make_unique<CausalStream<AttitudeEkf>>(std::make_unique<AttitudeEkf>(parameters));
}

std::unique_ptr<AttitudeStream> make_smoothed_stream(const FixedLagSmootherParameters& parameters) {
  return std::make_unique<SmoothedStream>(parameters);
}

}  // namespace gimbal
