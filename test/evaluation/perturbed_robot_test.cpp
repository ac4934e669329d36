#include "evaluation/app/perturbed_robot.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

/// Counts its frames; it has no joints and no wheels.
class Robot : public SteppedRobot, public FrameSource {
 public:
  bool advanceToNextFrame() override { return ++seq_ < 6; }
  FrameSource& camera() override { return *this; }
  PanTiltUnit& panTilt() override { throw std::logic_error("no joints"); }
  MobileBase& base() override { throw std::logic_error("no wheels"); }

  FrameCapabilities capabilities() const override { return {"counter", 4, 3, 10.0, false}; }
  PortReply configure(const FrameRequest&) override { return PortReply::accepted(); }
  PortReply start() override { return PortReply::accepted(); }
  void stop() override {}
  FrameResult next(std::chrono::milliseconds) override {
    Frame frame;
    frame.seq = seq_;
    frame.stamp_us = static_cast<StampUs>(seq_) * 100'000;
    frame.image = cv::Mat(3, 4, CV_8UC1, cv::Scalar(7));
    return {SourceState::kRunning, frame, ""};
  }

 private:
  std::uint64_t seq_ = 0;
};

TEST(PerturbedRobot, StepsAsTheRobotAndPerturbsWhatArrives) {
  Robot robot;
  PerturbedRobot stepped(robot, parsePerturbation("every=2,late=0.05,brightness=2").perturbation);
  EXPECT_EQ(stepped.camera().capabilities().name, "counter");
  std::vector<StampUs> stamps;
  while (stepped.advanceToNextFrame()) {
    const FrameResult result = stepped.camera().next(std::chrono::milliseconds(0));
    if (!result.frame) {
      EXPECT_EQ(result.state, SourceState::kWaiting);
      continue;
    }
    EXPECT_EQ(result.frame->image.at<unsigned char>(0, 0), 14);
    stamps.push_back(result.frame->stamp_us);
  }
  EXPECT_EQ(stamps, (std::vector<StampUs>{250'000, 450'000}));
}

}  // namespace
}  // namespace vismem
