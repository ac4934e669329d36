// The camera drivers under the contract of FrameSource.
#include "common/config/config_reader.h"
#include "contract/frame_source_contract.h"
#include "drivers/camera_files/file_camera.h"
#include "drivers/example_camera/pattern_camera.h"
#include "support/mjpeg_server.h"
#include "support/pictures.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

/// A source that is configured with its rate by the test's supply: what the contract asks for on top wins.
class PacedSource : public FrameSource {
 public:
  PacedSource(std::unique_ptr<FrameSource> source, double rate_hz)
      : source_(std::move(source)), rate_hz_(rate_hz) {}
  FrameCapabilities capabilities() const override { return source_->capabilities(); }
  PortReply configure(const FrameRequest& request) override {
    if (request.rate_hz != 0.0) return source_->configure(request);
    FrameRequest paced = request;
    paced.rate_hz = rate_hz_;
    return source_->configure(paced);
  }
  PortReply start() override { return source_->start(); }
  FrameResult next(std::chrono::milliseconds timeout) override { return source_->next(timeout); }
  void stop() override { source_->stop(); }

 private:
  std::unique_ptr<FrameSource> source_;
  double rate_hz_;
};

double rateOf(Supply supply) {
  return supply == Supply::kSteady ? 50.0 : 0.01;
}

class FileRig : public FrameSourceRig {
 public:
  FrameSource& source() override { return *camera_; }
  double period_s() const override { return 0.02; }

 protected:
  void use(const std::string& keys, double rate_hz) {
    const auto properties = Properties::parse(keys, "rig.cfg");
    ConfigReader config(properties);
    auto camera = makeFileCamera(config);
    config.finish();
    camera_ = std::make_unique<PacedSource>(std::move(camera), rate_hz);
  }
  TemporaryFolder folder_;

 private:
  std::unique_ptr<FrameSource> camera_;
};

/// @param ending of the images' names. @param extra keys.
std::unique_ptr<FrameSourceRig> folderRig(Supply supply, const std::string& ending,
                                          const std::string& extra = "") {
  class Rig : public FileRig {
   public:
    Rig(Supply supply, const std::string& ending, const std::string& extra) {
      for (int i = 0; i < 3; ++i) writePicture(folder_ / ("frame" + std::to_string(i) + ending), 40 * i);
      use("Source=" + folder_.path().string() + "\n" + extra, rateOf(supply));
    }
  };
  return std::make_unique<Rig>(supply, ending, extra);
}

std::unique_ptr<FrameSourceRig> imageRig(Supply supply) {
  class Rig : public FileRig {
   public:
    explicit Rig(Supply supply) {
      writePicture(folder_ / "still.png", 99);
      use("Source=" + (folder_ / "still.png") + "\n", rateOf(supply));
    }
  };
  return std::make_unique<Rig>(supply);
}

std::unique_ptr<FrameSourceRig> videoRig(Supply supply) {
  class Rig : public FileRig {
   public:
    explicit Rig(Supply supply) {
      const bool steady = supply == Supply::kSteady;
      writeVideo(folder_ / "walk.avi", steady ? 5 : 1, 50.0);
      use("Source=" + (folder_ / "walk.avi") + "\n" + (steady ? "" : "Loop=no\n"), 0.0);
    }
  };
  return std::make_unique<Rig>(supply);
}

std::unique_ptr<FrameSourceRig> streamRig(Supply supply) {
  class Rig : public FileRig {
   public:
    explicit Rig(Supply supply)
        : server_(supply == Supply::kSteady ? MjpegServer::Manner::kSteady : MjpegServer::Manner::kStalls) {
      use("Source=" + server_.url() + "\nReadTimeout_s=1\n", 0.0);
    }
    // Its pictures may come late from the other process thread; two of the server's periods.
    double period_s() const override { return 0.04; }

   private:
    MjpegServer server_;
  };
  return std::make_unique<Rig>(supply);
}

std::unique_ptr<FrameSourceRig> patternRig(Supply supply) {
  class Rig : public FrameSourceRig {
   public:
    explicit Rig(Supply supply) : camera_(std::make_unique<PatternCamera>(16), rateOf(supply)) {}
    FrameSource& source() override { return camera_; }
    double period_s() const override { return 0.02; }

   private:
    PacedSource camera_;
  };
  return std::make_unique<Rig>(supply);
}

INSTANTIATE_TEST_SUITE_P(
    Drivers, FrameSourceContract,
    testing::Values(FrameSourceCase{"png_folder", [](Supply s) { return folderRig(s, ".png"); }},
                    FrameSourceCase{"jpeg_folder", [](Supply s) { return folderRig(s, ".jpg"); }},
                    FrameSourceCase{"folder_own_stamps",
                                    [](Supply s) { return folderRig(s, ".ppm", "Stamps=own\n"); }},
                    FrameSourceCase{"single_image", imageRig}, FrameSourceCase{"video_file", videoRig},
                    FrameSourceCase{"network_stream", streamRig}, FrameSourceCase{"pattern", patternRig}),
    nameOfCase);

}  // namespace
}  // namespace vismem
