#include "common/vision/segment_extractor.h"

#include <utility>

#include "common/vision/label_split.h"
#include "common/vision/reduced_image.h"

namespace vismem {

SegmentExtractor::SegmentExtractor(ExtractorParams params, std::shared_ptr<const Palette> palette)
    : params_(std::move(params)),
      palette_(std::move(palette)),
      detector_(makeSegmentDetector(params_.detector)) {}
SegmentExtractor::~SegmentExtractor() = default;
SegmentExtractor::SegmentExtractor(SegmentExtractor&&) noexcept = default;
SegmentExtractor& SegmentExtractor::operator=(SegmentExtractor&&) noexcept = default;

std::vector<ImageSegment> SegmentExtractor::extract(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                                    StageProbe* probe) {
  // Merging uses ideal pixels, because the lens bends straight edges.
  auto segments = mergeSegments(extractPieces(image, intrinsics, probe), params_.merge);
  std::erase_if(segments, [this](const ImageSegment& segment) {
    return segment.px.length() < params_.minimum_length_px;
  });
  if (params_.gaps.enabled) segments = splitAtGaps(image, intrinsics, segments, params_.gaps);
  return segments;
}

std::vector<ImageSegment> SegmentExtractor::extractPieces(const cv::Mat& image,
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
  std::vector<ImageSegment> segments;
  segments.reserve(raw_.size());
  for (const RawSegment& raw : raw_) {
    std::vector<LabelledPiece> pieces{{raw.px_raw, kUnknownLabel}};
    if (palette_) {
      pieces = splitByLabel(image, raw.px_raw, *palette_, params_.labeller, params_.minimum_length_px);
    }
    for (const LabelledPiece& piece : pieces) {
      ImageSegment segment{piece.px_raw, piece.label, raw.strength};
      if (intrinsics.hasDistortion()) {
        segment.px = {undistortPixel(intrinsics, segment.px.a), undistortPixel(intrinsics, segment.px.b)};
      }
      segments.push_back(std::move(segment));
    }
  }
  return segments;
}

}  // namespace vismem
