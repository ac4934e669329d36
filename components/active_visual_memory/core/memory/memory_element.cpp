#include "active_visual_memory/core/memory/memory_element.h"

#include <algorithm>

namespace vismem {

void LabelVotes::add(const Label& label, double weight) {
  const std::span votes(votes_.data(), count_);
  const auto known = std::ranges::find(votes, label, &std::pair<Label, double>::first);
  if (known != votes.end()) {
    known->second += weight;
  } else if (count_ < kMost) {
    votes_[count_++] = {label, weight};
  } else {
    *std::ranges::min_element(votes, {}, &std::pair<Label, double>::second) = {label, weight};
  }
}

void LabelVotes::add(const LabelVotes& others) {
  for (std::size_t i = 0; i < others.count_; ++i) add(others.votes_[i].first, others.votes_[i].second);
}

Label LabelVotes::winner(double least_share) const {
  double all = 0.0;
  const std::pair<Label, double>* best = nullptr;
  for (const auto& vote : std::span(votes_.data(), count_)) {
    all += vote.second;
    if (vote.first != kUnknownLabel && (!best || vote.second > best->second)) best = &vote;
  }
  return best && best->second >= least_share * all ? best->first : kUnknownLabel;
}

std::vector<MemorySegment> valuesOf(std::span<const MemoryElement> elements) {
  std::vector<MemorySegment> values;
  values.reserve(elements.size());
  for (const MemoryElement& element : elements) {
    values.push_back(element.value);
    values.back().odom = onFloor(element.line.segment());
  }
  return values;
}

void absorb(MemoryElement& element, const MemoryElement& other, const FloorLine::Params& params) {
  const bool against = element.line.along().dot(other.line.along()) < 0.0;
  element.line.absorb(against ? FloorLine(reversed(other.line.asObservation()), params) : other.line, params);
  if (element.value.label == kUnknownLabel) element.value.label = other.value.label;
  element.votes.add(other.votes);
  if (!element.colours) element.colours = other.colours;
  element.strength = std::max(element.strength, other.strength);
  element.pixel_m = std::min(element.pixel_m, other.pixel_m);
  element.value.life = std::max(element.value.life, other.value.life);
  element.plane.on_floor = element.plane.on_floor || other.plane.on_floor;
  element.value.first_seen_us = std::min(element.value.first_seen_us, other.value.first_seen_us);
  element.value.last_seen_us = std::max(element.value.last_seen_us, other.value.last_seen_us);
  element.sighting = std::max(element.sighting, other.sighting);
  element.sightings = std::max(element.sightings, other.sightings);
}

bool isLocated(const MemorySegment& published) {
  const double largest = std::max(published.P_a.trace(), published.P_b.trace());
  return 0.5 * largest <= kMaxConfirmedSigma_m * kMaxConfirmedSigma_m;
}

void publish(MemoryElement& element, bool confirmed, const CameraTiltCovariance& P_tilt) {
  const auto place = [&](bool at_b, Eigen::Vector3d& p, Eigen::Matrix3d& P) {
    const FloorEnd end = element.line.floorEnd(at_b);
    p = {end.p.x(), end.p.y(), 0.0};
    P.setZero();
    P.topLeftCorner<2, 2>() = end.P + end.D * P_tilt * end.D.transpose();
  };
  place(false, element.value.odom.a, element.value.P_a);
  place(true, element.value.odom.b, element.value.P_b);
  element.value.uncertainty = uncertaintyOf(element.value.life);
  element.value.confirmed = confirmed;
  element.value.off_floor = element.plane.stands;
}

}  // namespace vismem
