#include "common/vision/segment_extractor.h"

#include <utility>

#include "common/vision/reduced_image.h"

namespace vismem {

SegmentExtractor::SegmentExtractor(ExtractorParams params, std::shared_ptr<const Palette> palette)
    : params_(std::move(params)),
      palette_(std::move(palette)),
      detector_(makeSegmentDetector(params_.detector)) {
  if (palette_) splitter_.emplace(*palette_, params_.labeller);
}
SegmentExtractor::~SegmentExtractor() = default;
SegmentExtractor::SegmentExtractor(SegmentExtractor&&) noexcept = default;
SegmentExtractor& SegmentExtractor::operator=(SegmentExtractor&&) noexcept = default;

const std::vector<ImageSegment>& SegmentExtractor::extract(const cv::Mat& image,
                                                           const CameraIntrinsics& intrinsics,
                                                           StageProbe* probe) {
  extractPieces(image, intrinsics, probe);
  // Merging uses ideal pixels, because the lens bends straight edges.
  merger_.merge(segments_, params_.merge);
  std::erase_if(segments_, [this](const ImageSegment& segment) {
    return segment.px.length() < params_.minimum_length_px;
  });
  return segments_;
}

const std::vector<ImageSegment>& SegmentExtractor::extractPieces(const cv::Mat& image,
                                                                 const CameraIntrinsics& intrinsics,
                                                                 StageProbe* probe) {
  requireSize(image, intrinsics);
  enterStage(probe, "detect");
  detector_->detect(image, raw_);
  if (params_.colour_edges && image.channels() == 3) {
    strongestChannel(image, plane_);
    detector_->detect(plane_, in_plane_);
    joiner_.join(image, in_plane_, raw_);
  }
  enterStage(probe, "label");
  segments_.clear();
  for (const RawSegment& raw : raw_) {
    const LabelledPiece whole{raw.px_raw, &kUnknownLabel};
    const auto pieces =
        splitter_ ? splitter_->split(image, raw.px_raw, params_.minimum_length_px) : std::span(&whole, 1);
    for (const LabelledPiece& piece : pieces) {
      ImageSegment segment{piece.px_raw, *piece.label, raw.strength};
      if (intrinsics.hasDistortion()) {
        segment.px = {undistortPixel(intrinsics, segment.px.a), undistortPixel(intrinsics, segment.px.b)};
      }
      segments_.push_back(std::move(segment));
    }
  }
  return segments_;
}

}  // namespace vismem
