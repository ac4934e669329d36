/// @file Errors of a detector against the true visible edges. Pure. See V1, V3, E5, E6, E7, E8.
#pragma once

#include <array>
#include <vector>

#include "common/vision/image_segment.h"
#include "experiments/trials/lasting_error.h"
#include "experiments/trials/visible_pieces.h"

namespace vismem {

/// Adds up over images. *Single-threaded*.
class VisionStatistics {
 public:
  /// Pieces by their length in the image [px]: the borders of the bins; the last one is open.
  static constexpr std::array<double, 8> kLengths_px{4, 8, 12, 20, 30, 50, 80, 140};
  /// Ranges of pieces on the floor of at least kFarFrom_px [m].
  static constexpr std::array<double, 6> kRanges_m{0, 1, 2, 3, 4, 6};
  static constexpr double kFarFrom_px = 20.0;
  static constexpr double kBeyond_px = 40.0;
  static constexpr double kShort_px = 8.0;
  static std::size_t rangeBin(double range_m);

  struct Bin {
    int pieces = 0;
    int found = 0;            ///< pieces of which at least half the length was found with its label
    double length_found = 0;  ///< sum of the found shares of the length
    int fragments = 0;        ///< segments on the pieces found
  };

  /// Begins another run, with its own time.
  void beginRun();
  /// @param edges of the map.
  /// @param visible pieces of this image, outlines too.
  /// @param observed segments of this image.
  void add(double time_s, const CameraIntrinsics& intrinsics, const SegmentMap& edges,
           const std::vector<VisiblePiece>& visible, const std::vector<ImageSegment>& observed);

  int images() const { return images_; }
  const std::array<Bin, kLengths_px.size()>& byLength() const { return by_length_; }
  const std::array<Bin, kRanges_m.size()>& byRange() const { return by_range_; }
  /// Distance of an end beside the line, to the brighter side [px]; of segments on pieces of kFarFrom_px or
  /// longer.
  const LastingError& across(bool on_floor) const { return on_floor ? across_floor_ : across_upright_; }
  /// Distance of an end beyond (positive) or short of the edge's end [px], of the same segments. Longer
  /// continuations than kBeyond_px are left out; an end short by more than kShort_px counts as a break.
  const LastingError& along(bool on_floor) const { return on_floor ? along_floor_ : along_upright_; }
  /// The same of floor edges, by range.
  const std::array<LastingError, kRanges_m.size()>& acrossByRange() const { return across_by_range_; }
  const std::array<LastingError, kRanges_m.size()>& alongByRange() const { return along_by_range_; }
  /// The same at ends of floor edges that a nearer object occludes; atBorder at ends that the image's border
  /// cuts.
  const LastingError& atHidden() const { return at_hidden_; }
  /// The same at the foot and at the upper end of a wall's outline (visibleOutlines) that was found with its
  /// label; outlinesFound is the found share of those of kFarFrom_px or longer.
  const LastingError& atOutline(bool foot) const { return foot ? outline_foot_ : outline_top_; }
  double outlinesFound() const {
    return outlines_ > 0 ? static_cast<double>(outlines_found_) / outlines_ : 0.0;
  }
  double outlinesPerImage() const { return images_ > 0 ? static_cast<double>(outlines_) / images_ : 0.0; }
  const LastingError& atBorder() const { return at_border_; }
  /// Labelled segments of an image that belong to no piece of their label, their share of the labelled, and
  /// the share of those that have a label of the floor's edges.
  double falsePerImage() const { return images_ > 0 ? static_cast<double>(false_) / images_ : 0.0; }
  double falseShare() const { return labelled_ > 0 ? static_cast<double>(false_) / labelled_ : 0.0; }
  double falseOnFloorShare() const {
    return false_ > 0 ? static_cast<double>(false_on_floor_) / false_ : 0.0;
  }
  double falseLength_px() const { return false_ > 0 ? false_length_ / false_ : 0.0; }
  /// Of the segments that lie on a piece, the share without a label or with another one.
  double wrongLabelShare() const {
    return on_piece_ > 0 ? static_cast<double>(wrong_label_) / on_piece_ : 0.0;
  }
  /// Share of segments whose brighter side is not where it should be.
  double wrongSideShare() const { return right_ > 0 ? static_cast<double>(wrong_side_) / right_ : 0.0; }
  /// How often a piece of 20 px or more that was missed in the last image is missed again, and how often it
  /// is missed at all: persistence.
  double missedAgain() const { return missed_ > 0 ? static_cast<double>(missed_twice_) / missed_ : 0.0; }
  double missed() const { return could_ > 0 ? static_cast<double>(missed_now_) / could_ : 0.0; }

 private:
  int images_ = 0;
  std::array<Bin, kLengths_px.size()> by_length_{};
  std::array<Bin, kRanges_m.size()> by_range_{};
  LastingError across_floor_;
  LastingError across_upright_;
  LastingError along_floor_;
  LastingError along_upright_;
  std::array<LastingError, kRanges_m.size()> along_by_range_;
  std::array<LastingError, kRanges_m.size()> across_by_range_;
  LastingError at_hidden_;
  LastingError outline_foot_;
  LastingError outline_top_;
  LastingError at_border_;
  int labelled_ = 0;
  int false_ = 0;
  int false_on_floor_ = 0;
  int outlines_ = 0;
  int outlines_found_ = 0;
  double false_length_ = 0.0;
  int on_piece_ = 0;
  int wrong_label_ = 0;
  int right_ = 0;
  int wrong_side_ = 0;
  int missed_ = 0;
  int missed_twice_ = 0;
  int missed_now_ = 0;
  int could_ = 0;
  std::vector<int> last_missed_;  ///< edges, of the last image
  std::vector<int> last_shown_;
};

}  // namespace vismem
