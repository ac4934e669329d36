/// @file The chapter's races as published. Pure. See L3-L9.
#pragma once

#include <memory>

#include "common/segment_map/segment_map.h"
#include "localization/core/hypotheses/evolution.h"
#include "localization/core/hypotheses/explorers.h"
#include "localization/core/hypotheses/race_strategy.h"
#include "localization/core/likelihood/chapter_health.h"
#include "localization/core/map/map_index.h"

namespace vismem {

struct ChapterParams {
  MapParams map;
  ExplorerParams explorers;
  EvolutionParams evolution;
  HealthParams health;
};

std::unique_ptr<RaceStrategy> makeChapterRaces(const SegmentMap& map_edges, const ChapterParams& params);

}  // namespace vismem
