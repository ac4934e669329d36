#include "drivers/camera_files/file_camera.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <utility>

#include "drivers/camera_files/capture_session.h"
#include "drivers/camera_files/image_folder.h"
#include "drivers/camera_files/video_source.h"

namespace vismem {
namespace {

struct Look {
  cv::Size size;
  double own_rate_hz = 0.0;
};

/// Size and rate of the first readable image; empty if there is none yet.
Look lookAt(PictureSource& source) {
  Look look;
  if (!source.open().empty()) return look;
  look.own_rate_hz = source.ownRate_hz();
  for (PictureResult result = source.read();; result = source.read()) {
    if (result.kind == PictureResult::Kind::kLost) continue;
    if (result.kind == PictureResult::Kind::kPicture) {
      look.size = {result.picture.width(), result.picture.height()};
    }
    break;
  }
  source.close();
  return look;
}

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

bool isAddress(const std::string& source) {
  return source.find("://") != std::string::npos;
}

bool isVideoName(const std::filesystem::path& file) {
  static const std::set<std::string> kEndings = {".avi", ".flv", ".m4v",  ".mjpeg", ".mjpg", ".mkv",  ".mov",
                                                 ".mp4", ".mpg", ".mpeg", ".ogv",   ".ts",   ".webm", ".wmv"};
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return kEndings.contains(ending);
}

/// The kind of an absent source follows from its name: a name without an ending is a folder.
std::unique_ptr<PictureSource> openerOf(const std::string& source, const NetworkStream::Timeouts& timeouts) {
  if (isAddress(source)) return std::make_unique<NetworkStream>(source, timeouts);
  const std::filesystem::path path = source;
  std::error_code error;
  const bool other_file = std::filesystem::is_regular_file(path, error) && !isImageName(path);
  if (other_file || (isVideoName(path) && !std::filesystem::is_directory(path, error))) {
    return std::make_unique<VideoFile>(path);
  }
  return std::make_unique<ImageFolder>(path);
}

}  // namespace

cv::Size fittingSize(cv::Size own, cv::Size asked) {
  if (asked.width <= 0 && asked.height <= 0) return own;
  const double across = asked.width > 0 ? static_cast<double>(asked.width) / own.width : 1e9;
  const double down = asked.height > 0 ? static_cast<double>(asked.height) / own.height : 1e9;
  // A size that rounds to the requested one becomes the requested one.
  if (std::abs(across / down - 1.0) < 0.01) return asked;
  const double scale = std::min(across, down);
  const auto scaled = [scale](int side) { return std::max(1, static_cast<int>(std::lround(side * scale))); };
  return {scaled(own.width), scaled(own.height)};
}

FileCamera::FileCamera(MakeSource make_source, const Params& params)
    : make_source_(std::move(make_source)),
      params_(params),
      name_(make_source_()->name()),
      live_(make_source_()->isLive()) {
  known_.name = name_;
}

FileCamera::~FileCamera() {
  stop();
}

FrameCapabilities FileCamera::capabilities() const {
  const std::lock_guard lock(mutex_);
  FrameCapabilities capabilities = known_;
  if (session_) {
    if (const FrameCapabilities seen = session_->known(); seen.width > 0) capabilities = seen;
  }
  capabilities.name = name_;
  return capabilities;
}

PortReply FileCamera::configure(const FrameRequest& request) {
  if (auto rejection = rejectAbsurd(request)) return *rejection;
  {
    const std::lock_guard lock(mutex_);
    if (session_) return PortReply::rejected("the camera runs; stop it before it is configured");
  }
  std::vector<std::string> changes;
  Look look;
  // A stream may open slowly: its size and rate are known only while it runs.
  if (!live_) look = lookAt(*make_source_());
  const bool size_asked = request.width > 0 || request.height > 0;
  cv::Size size;
  if (!look.size.empty()) {
    size = fittingSize(look.size, {request.width, request.height});
    if ((request.width > 0 && size.width != request.width) ||
        (request.height > 0 && size.height != request.height)) {
      changes.push_back(std::to_string(size.width) + "x" + std::to_string(size.height) +
                        ", of the shape of the pictures");
    }
  } else if (size_asked) {
    changes.push_back("no picture was seen yet: they will be scaled to fit");
  }
  const bool rate_asked = request.rate_hz > 0.0;
  double rate_hz = look.own_rate_hz > 0.0 ? look.own_rate_hz
                   : rate_asked           ? std::min(request.rate_hz, kMaxRate_hz)
                                          : params_.default_rate_hz;
  if (live_) rate_hz = 0.0;
  if (rate_asked && rate_hz != request.rate_hz) {
    changes.push_back(
        live_ ? "the rate is the stream's own"
              : text(rate_hz) + " Hz" +
                    (look.own_rate_hz > 0.0 ? ", the pictures' own rate" : ", the most there is"));
  }
  const std::lock_guard lock(mutex_);
  request_ = request;
  known_.width = size.width;
  known_.height = size.height;
  known_.rate_hz = rate_hz;
  if (changes.empty()) return PortReply::accepted();
  return PortReply::adjusted(changes.size() == 1 ? changes[0] : changes[0] + "; " + changes[1]);
}

PortReply FileCamera::start() {
  const std::lock_guard lock(mutex_);
  if (session_) return PortReply::accepted();
  std::erase_if(ending_, [](const auto& session) { return session->hasEnded(); });
  session_ =
      std::make_shared<Session>(make_source_(), params_, request_, Session::Begin{last_seq_, last_stamp_us_});
  return PortReply::accepted();
}

FrameResult FileCamera::next(std::chrono::milliseconds timeout) {
  std::shared_ptr<Session> session;
  {
    const std::lock_guard lock(mutex_);
    session = session_;
  }
  if (!session) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
  return session->next(timeout);
}

void FileCamera::stop() {
  const std::lock_guard lock(mutex_);
  if (!session_) return;
  session_->stop();
  const Session::Begin reached = session_->reached();
  last_seq_ = reached.seq;
  last_stamp_us_ = reached.stamp_us;
  if (const FrameCapabilities seen = session_->known(); seen.width > 0) known_ = seen;
  ending_.push_back(std::move(session_));
}

std::unique_ptr<FrameSource> makeFileCamera(ConfigReader& group) {
  FileCamera::Params params;
  NetworkStream::Timeouts timeouts;
  group.describe({basic("Source", "of the images"), basic("Loop", "begin again after the last image"),
                  expert("Stamps", "of this host's clock, or the file's own"),
                  expert("OpenTimeout_s", "longest wait for a stream to open"),
                  expert("ReadTimeout_s", "longest wait for a stream's next image")});
  std::string source = group.requiredText(
      "Source", "a folder of images, an image, a video or an address such as rtsp://host/path");
  params.loop = group.boolean("Loop", params.loop);
  params.stamps = group.choice("Stamps", params.stamps,
                               {{"host", FileCamera::Stamps::kHost}, {"own", FileCamera::Stamps::kOwn}});
  timeouts.open_s = group.real("OpenTimeout_s", timeouts.open_s, 0.1, 60.0);
  timeouts.read_s = group.real("ReadTimeout_s", timeouts.read_s, 0.1, 60.0);
  if (isAddress(source)) {
    if (params.stamps == FileCamera::Stamps::kOwn)
      group.problem("Stamps", "a stream has no stamps of its own");
  } else {
    source = group.path("Source").string();
  }
  return std::make_unique<FileCamera>([source, timeouts] { return openerOf(source, timeouts); }, params);
}

}  // namespace vismem
