#include "localization/app/config.h"

#include <map>
#include <sstream>
#include <vector>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "common/segment_map/map_check.h"
#include "common/vision/palette.h"

namespace vismem {
namespace {

constexpr double kFar = 1e4;

ObservationSource readSource(ConfigReader& r, ObservationSource fallback) {
  return r.choice("Source", fallback,
                  {{"memory", ObservationSource::kMemory},
                   {"image", ObservationSource::kImage},
                   {"both", ObservationSource::kBoth}});
}

int count(ConfigReader& r, const char* name, int fallback, int minimum, int maximum) {
  return static_cast<int>(r.integer(name, fallback, minimum, maximum));
}

void readRaces(ConfigReader r, RaceParams& p) {
  p.maximum = count(r, "Maximum", p.maximum, 1, 64);
  p.same_place_m = r.real("SamePlace_m", p.same_place_m, 0.01, 10.0);
  p.same_place_rad = r.angleDeg("SamePlace_deg", radToDeg(p.same_place_rad), 0.5, 180.0);
  p.create_health = r.real("CreateHealth", p.create_health, 0.0, 1.0);
  p.delete_health = r.real("DeleteHealth", p.delete_health, 0.0, 1.0);
  p.protected_age = count(r, "ProtectedAge", p.protected_age, 0, 1000);
  p.protected_after_best = count(r, "ProtectedAfterBest", p.protected_after_best, 0, 1000);
  p.maximum_victories = count(r, "MaximumVictories", p.maximum_victories, 1, 1000);
  r.alias("SparedAhead", "ProtectedLogOdds");
  p.protected_log_odds = r.real("ProtectedLogOdds", p.protected_log_odds, 0.0, 1e6);
}

void readExplorers(ConfigReader r, ExplorerParams& p) {
  p.count_lost = count(r, "CountLost", p.count_lost, 0, 100'000);
  p.count_reliable = count(r, "CountReliable", p.count_reliable, 0, 100'000);
  p.period_reliable = count(r, "PeriodReliable", p.period_reliable, 1, 1000);
  p.reliable_above = r.real("ReliableAbove", p.reliable_above, 0.0, 1.0);
  p.candidates = count(r, "Candidates", p.candidates, 1, 64);
  p.list_health = r.real("ListHealth", p.list_health, 0.0, 1.0);
  p.margin_m = r.real("Margin_m", p.margin_m, 0.0, kFar);
}

void readEvolution(ConfigReader r, EvolutionParams& p) {
  p.individuals = count(r, "Individuals", p.individuals, 1, 10'000);
  p.elitism = r.real("Elitism", p.elitism, 0.0, 1.0);
  p.crossover = r.real("Crossover", p.crossover, 0.0, 1.0);
  p.noise_m = r.real("Noise_m", p.noise_m, 0.0, 10.0);
  p.noise_rad = r.angleDeg("Noise_deg", radToDeg(p.noise_rad), 0.0, 180.0);
  if (p.elitism + p.crossover > 1.0) r.problem("Crossover", "must not be more than 1 - " + r.key("Elitism"));
}

void readHealth(ConfigReader r, HealthParams& p) {
  p.source = readSource(r, p.source);
  p.use_field = r.boolean("UseField", p.use_field);
  p.memory_scale_m = r.real("MemoryScale_m", p.memory_scale_m, 0.01, kFar);
  p.image_scale_px = r.real("ImageScale_px", p.image_scale_px, 1.0, kFar);
  p.memory_range_m = r.real("MemoryRange_m", p.memory_range_m, 0.1, kFar);
  p.grid_top_px = r.real("GridTop_px", p.grid_top_px, 2.0, 240.0);
  p.grid_bottom_px = r.real("GridBottom_px", p.grid_bottom_px, 2.0, 240.0);
  if (p.grid_top_px > p.grid_bottom_px) {
    r.problem("GridTop_px", "must not be more than " + r.key("GridBottom_px"));
  }
}

void readObservation(ConfigReader& r, ObservationParams& p) {
  p.source = readSource(r, p.source);
  p.image_share = r.real("ImageShare", p.image_share, 0.0, 1.0);
  p.memory_below_points = r.real("MemoryBelow_points", p.memory_below_points, 0.0, 1e6);
  p.image_range_m = r.real("ImageRange_m", p.image_range_m, 0.1, kFar);
  p.camera_sigma_rad = r.angleDeg("CameraSigma_deg", radToDeg(p.camera_sigma_rad), 0.0, 20.0);
  p.point_step_m = r.real("PointStep_m", p.point_step_m, 0.01, 10.0);
  p.maximum_points = count(r, "MaximumPoints", p.maximum_points, 10, 100'000);
  p.range_m = r.real("Range_m", p.range_m, 0.1, kFar);
  p.half_life_s = r.real("HalfLife_s", p.half_life_s, 0.0, 1e6);
  p.unconfirmed_weight = r.real("UnconfirmedWeight", p.unconfirmed_weight, 0.0, 1.0);
  p.effective_points = r.real("EffectivePoints", p.effective_points, 1.0, 1e6);
  p.end_metres = r.real("EndMetres", p.end_metres, 0.0, 10.0);
  p.points_per_metre = r.real("PointsPerMetre", p.points_per_metre, 0.01, 1e4);
  p.sigma_m = r.real("Sigma_m", p.sigma_m, 0.001, 10.0);
  p.maximum_sigma_m = r.real("MaximumSigma_m", p.maximum_sigma_m, 0.001, 10.0);
  if (p.maximum_sigma_m < p.sigma_m) r.problem("MaximumSigma_m", "must not be less than " + r.key("Sigma_m"));
  p.remembered_sigma_m = r.real("RememberedSigma_m", p.remembered_sigma_m, 0.001, 10.0);
  if (p.maximum_sigma_m < p.remembered_sigma_m) {
    r.problem("MaximumSigma_m", "must not be less than " + r.key("RememberedSigma_m"));
  }
  p.drift_sigma_mps = r.real("DriftSigma_mps", p.drift_sigma_mps, 0.0, 10.0);
}

void readLikelihood(ConfigReader& r, LikelihoodParams& p) {
  p.outlier_share = r.real("OutlierShare", p.outlier_share, 1e-6, 0.9);
  p.bounded = r.boolean("Bounded", p.bounded);
  p.direction_gate = r.boolean("DirectionGate", p.direction_gate);
  p.direction_gate_rad = r.angleDeg("DirectionGate_deg", radToDeg(p.direction_gate_rad), 1.0, 90.0);
  p.use_field = r.boolean("UseField", p.use_field);
  r.alias("LeanBias_deg", "CameraTilt.Bias_deg");
  p.tilt_bias_rad = r.angleDeg("CameraTilt.Bias_deg", radToDeg(p.tilt_bias_rad), 0.0, 20.0);
  r.alias("LeanSway_deg", "CameraTilt.PerFrame_deg");
  p.frame_tilt_rad = r.angleDeg("CameraTilt.PerFrame_deg", radToDeg(p.frame_tilt_rad), 0.0, 20.0);
  p.memory_shift_m = r.real("MemoryShift_m", p.memory_shift_m, 0.0, 10.0);
  p.memory_turn_rad = r.angleDeg("MemoryTurn_deg", radToDeg(p.memory_turn_rad), 0.0, 90.0);
  p.explained_sigma_m = r.real("ExplainedSigma_m", p.explained_sigma_m, 0.0, 10.0);
}

void readFilter(ConfigReader& r, RaceFilterParams& p) {
  p.refinement_steps = count(r, "RefinementSteps", p.refinement_steps, 0, 100);
  p.kalman = r.boolean("Kalman", p.kalman);
  p.odometry_share = r.real("OdometryShare", p.odometry_share, 0.0, 10.0);
  p.odometry_turn_share = r.real("OdometryTurnShare", p.odometry_turn_share, 0.0, 10.0);
  p.odometry_turn_per_m = r.angleDeg("OdometryTurn_degpm", radToDeg(p.odometry_turn_per_m), 0.0, 180.0);
  p.walk_m = r.real("Walk_m", p.walk_m, 0.0, 1.0);
  p.walk_rad = r.angleDeg("Walk_deg", radToDeg(p.walk_rad), 0.0, 90.0);
  p.information_share = r.real("InformationShare", p.information_share, 1e-4, 1.0);
}

void readEvidence(ConfigReader& r, EvidenceParams& p, ScoreHistoryParams& history, NoveltyParams& novelty) {
  r.alias("NewsShare", "NoveltyShare");
  p.novelty_share = r.real("NoveltyShare", p.novelty_share, 0.0, 1.0);
  p.lead = r.real("Lead", p.lead, 0.0, 1e6);
  p.delete_behind = r.real("DeleteBehind", p.delete_behind, 0.0, 1e6);
  history.forgetting = r.real("Forgetting", history.forgetting, 0.0, 0.9999);
  r.alias("BirthPenalty", "JumpLogPrior");
  history.jump_log_prior = r.real("JumpLogPrior", history.jump_log_prior, 0.0, 1e6);
  r.alias("Repeats", "HalfNoveltyViews");
  novelty.half_novelty_views = r.real("HalfNoveltyViews", novelty.half_novelty_views, 0.0, 1e6);
  r.alias("RepeatTime_s", "NoveltyDecay_s");
  novelty.novelty_decay_s = r.real("NoveltyDecay_s", novelty.novelty_decay_s, 0.01, 1e6);
}

void readRobustExplorers(ConfigReader& r, RobustExplorerParams& p) {
  p.constructed_share = r.real("ConstructedShare", p.constructed_share, 0.0, 1.0);
  p.uniform_area_m2 = r.real("UniformArea_m2", p.uniform_area_m2, 0.0, 1e12);
  p.landmark_share = r.real("LandmarkShare", p.landmark_share, 0.0, 1.0);
  p.landmarks.corners = r.boolean("Corners", p.landmarks.corners);
  p.landmarks.doors = r.boolean("Doors", p.landmarks.doors);
  p.landmarks.parallelograms = r.boolean("Parallelograms", p.landmarks.parallelograms);
  p.kld_error = r.real("KldError", p.kld_error, 0.0, 10.0);
  p.kld_place_m = r.real("KldPlace_m", p.kld_place_m, 0.01, kFar);
  p.kld_place_rad = r.angleDeg("KldPlace_deg", radToDeg(p.kld_place_rad), 1.0, 360.0);
  p.kld_least = count(r, "KldLeast", p.kld_least, 1, 100'000);
  p.refined_explorers = count(r, "RefinedExplorers", p.refined_explorers, 1, 1000);
}

void readReliability(ConfigReader& r, ReliabilityParams& p) {
  p.validity = r.boolean("Validity", p.validity);
  p.time_constant_s = r.real("ReliabilityTime_s", p.time_constant_s, 0.01, 1e4);
  p.enough_points = r.real("EnoughPoints", p.enough_points, 0.01, 1e6);
  p.explained_low = r.real("ExplainedLow", p.explained_low, 0.0, 1.0);
  p.explained_high = r.real("ExplainedHigh", p.explained_high, 0.0, 1.0);
  if (p.explained_low >= p.explained_high) {
    r.problem("ExplainedLow", "must be less than " + r.key("ExplainedHigh"));
  }
}

void readRobust(ConfigReader r, RobustParams& p) {
  readObservation(r, p.observation);
  readLikelihood(r, p.likelihood);
  p.negative.enabled = r.boolean("NegativeInformation", p.negative.enabled);
  p.negative.detection_probability =
      r.real("DetectionProbability", p.negative.detection_probability, 0.0, 0.99);
  readFilter(r, p.filter);
  readEvidence(r, p.evidence, p.history, p.novelty);
  readRobustExplorers(r, p.explorers);
  readReliability(r, p.reliability);
}

void readOdometry(ConfigReader r, OdometryCalibrationParams& p) {
  r.alias("Learn", "Calibrate");
  p.enabled = r.boolean("Calibrate", p.enabled);
  p.turn_per_m = r.angleDeg("Turn_degpm", radToDeg(p.turn_per_m), 0.0, 180.0);
  p.turn_share = r.real("TurnShare", p.turn_share, 0.0, 1.0);
  p.travel_share = r.real("TravelShare", p.travel_share, 0.0, 1.0);
  p.walk_share = r.real("WalkShare", p.walk_share, 0.0, 1.0);
  p.piece_m = r.real("Piece_m", p.piece_m, 0.05, 100.0);
  p.piece_rad = r.angleDeg("Piece_deg", radToDeg(p.piece_rad), 5.0, 3600.0);
  p.pose_std_m = r.real("Pose_m", p.pose_std_m, 1e-4, 1.0);
  p.pose_std_rad = r.angleDeg("Pose_deg", radToDeg(p.pose_std_rad), 0.01, 45.0);
  p.noise_rad_per_root_m = r.angleDeg("Noise_deg", radToDeg(p.noise_rad_per_root_m), 0.0, 90.0);
  p.noise_rad_per_root_rad = r.real("TurnNoise", p.noise_rad_per_root_rad, 0.0, 1.0);
  p.noise_m_per_root_m = r.real("Noise_m", p.noise_m_per_root_m, 0.0, 1.0);
  p.gate_sigmas = r.real("GateSigmas", p.gate_sigmas, 0.1, 100.0);
  p.trust = r.real("Trust", p.trust, 0.0, 1.0);
}

std::vector<std::string> readWords(ConfigReader& r, const char* name,
                                   const std::vector<std::string>& fallback) {
  std::string joined;
  for (const std::string& word : fallback) joined += (joined.empty() ? "" : " ") + word;
  std::istringstream text(r.text(name, joined));
  std::vector<std::string> words;
  for (std::string word; text >> word;) words.push_back(word);
  return words;
}

}  // namespace

LocalizerParams readLocalizerParams(ConfigReader& reader) {
  const auto mode =
      reader.choice("Mode", LocalizationMode::kDefault,
                    {{"default", LocalizationMode::kDefault}, {"chapter", LocalizationMode::kChapter}});
  LocalizerParams params = localizerPreset(mode);
  params.tick_s = reader.real("Tick_s", params.tick_s, 0.001, 60.0);
  reader.alias("DoubtTick_s", "SuspectTick_s");
  params.suspect_tick_s = reader.real("SuspectTick_s", params.suspect_tick_s, 0.001, 60.0);
  reader.alias("Doubt_s", "SuspectTime_s");
  params.suspect_time_s = reader.real("SuspectTime_s", params.suspect_time_s, 0.0, 3600.0);
  params.map.cell_m = reader.real("Cell_m", params.map.cell_m, 0.05, 10.0);
  params.map.opaque_labels = readWords(reader, "OpaqueLabels", params.map.opaque_labels);
  readRaces(reader.group("Races"), params.races);
  readExplorers(reader.group("Explorers"), params.explorers);
  readEvolution(reader.group("Evolution"), params.evolution);
  readHealth(reader.group("Health"), params.health);
  readRobust(reader.group("Robust"), params.robust);
  params.rate_at_image_stamp = reader.boolean("Robust.RateAtImageStamp", params.rate_at_image_stamp);
  readOdometry(reader.group("Odometry"), params.odometry);
  return params;
}

GazePlannerParams readGazePlannerParams(ConfigReader& reader) {
  GazePlannerParams p;
  ConfigReader r = reader.group("Gaze");
  r.alias("DoubtAbove", "UncertaintyAbove");
  p.uncertainty_above = r.real("UncertaintyAbove", p.uncertainty_above, 0.0, 1.0);
  p.least_priority = r.real("LeastPriority", p.least_priority, 0.01, 100.0);
  p.most_priority = r.real("MostPriority", p.most_priority, 0.01, 100.0);
  if (p.most_priority < p.least_priority) {
    r.problem("MostPriority", "must not be less than " + r.key("LeastPriority"));
  }
  p.confirm_s = r.real("Confirm_s", p.confirm_s, 0.0, 60.0);
  p.deadline_s = r.real("Deadline_s", p.deadline_s, 0.1, 60.0);
  p.seen_rad = r.angleDeg("Seen_deg", radToDeg(p.seen_rad), 0.5, 90.0);
  p.move_rad = r.angleDeg("Move_deg", radToDeg(p.move_rad), 0.0, 90.0);
  GazeAdvisorParams& a = p.advisor;
  a.minimum_pan_rad = r.angleDeg("Pan.Minimum_deg", radToDeg(a.minimum_pan_rad), -180.0, 180.0);
  a.maximum_pan_rad = r.angleDeg("Pan.Maximum_deg", radToDeg(a.maximum_pan_rad), -180.0, 180.0);
  if (a.minimum_pan_rad > a.maximum_pan_rad) {
    r.problem("Pan.Minimum_deg", "must not be more than " + r.key("Pan.Maximum_deg"));
  }
  a.minimum_tilt_rad = r.angleDeg("Tilt.Minimum_deg", radToDeg(a.minimum_tilt_rad), -90.0, 90.0);
  a.maximum_tilt_rad = r.angleDeg("Tilt.Maximum_deg", radToDeg(a.maximum_tilt_rad), -90.0, 90.0);
  if (a.minimum_tilt_rad > a.maximum_tilt_rad) {
    r.problem("Tilt.Minimum_deg", "must not be more than " + r.key("Tilt.Maximum_deg"));
  }
  a.step_rad = r.angleDeg("Step_deg", radToDeg(a.step_rad), 1.0, 90.0);
  a.range_m = r.real("Range_m", a.range_m, 0.1, kFar);
  a.sigma_m = r.real("Sigma_m", a.sigma_m, 0.001, 10.0);
  a.none_share = r.real("NoneShare", a.none_share, 0.0, 1.0);
  a.horizon_s = r.real("Horizon_s", a.horizon_s, 0.1, 10.0);
  a.patience_s = r.real("Patience_s", a.patience_s, 0.01, 100.0);
  r.alias("Repeat_s", "HalfNovelty_s");
  a.half_novelty_s = r.real("HalfNovelty_s", a.half_novelty_s, 0.001, 100.0);
  a.forget_s = r.real("Forget_s", a.forget_s, 0.1, 1e4);
  a.head_speed_radps = r.angleDeg("HeadSpeed_degps", radToDeg(a.head_speed_radps), 1.0, 2000.0);
  a.head_acceleration_radps2 =
      r.angleDeg("HeadAcceleration_degps2", radToDeg(a.head_acceleration_radps2), 1.0, 100'000.0);
  a.delay_s = r.real("Delay_s", a.delay_s, 0.0, 10.0);
  return p;
}

LocalizationConfig readLocalizationConfig(ConfigReader& reader) {
  LocalizationConfig config;
  config.visual_memory_proxy = reader.requiredText(
      "VisualMemory.Proxy", "the proxy of a visual memory, such as VisualMemory:tcp -h 127.0.0.1 -p 9970");
  config.map = reader.requireFile("Map", "a map of labelled segments, such as cfg/maps/corridor.csv");
  config.palette = reader.existingFile("Palette", "a palette, such as cfg/maps/corridor.palette");
  config.seed = static_cast<std::uint64_t>(reader.integer("Seed", 1, 0, 2'000'000'000));
  if (reader.isSet("Start.Position_m") || reader.isSet("Start.Heading_deg")) {
    const std::vector<double> position = reader.reals("Start.Position_m", {0.0, 0.0}, -kFar, kFar);
    config.start = Pose2{position[0], position[1], reader.angleDeg("Start.Heading_deg", 0.0, -360.0, 360.0)};
  }
  reader.known("Start.Position_m");
  reader.known("Start.Heading_deg");
  config.pose3d_scale = reader.boolean("Pose3D.MillimetreScale", false) ? 1000.0 : 1.0;
  config.gaze_proxy = reader.text("Gaze.Proxy", "");
  config.gaze = readGazePlannerParams(reader);
  config.params = readLocalizerParams(reader);
  return config;
}

LoadedMap loadMapEdges(const std::filesystem::path& map, const std::filesystem::path& palette) {
  SegmentMap rows;
  PaletteLabels labels;
  std::vector<std::string> warnings;
  std::vector<std::string> problems;
  const auto collect = [&problems](auto&& step) {
    try {
      step();
    } catch (const ConfigError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  };
  collect([&] { rows = loadSegmentMap(map); });
  collect([&] {
    if (palette.empty()) return;
    const Palette colours = loadPalette(palette);
    const std::vector<Label> edges = colours.labels();
    labels = {{edges.begin(), edges.end()}, colours.stripes()};
    warnings = colours.warnings();
  });
  if (!problems.empty()) throw ConfigError(problems);
  LoadedMap loaded{rows, expandStripes(rows, labels.stripes), std::move(warnings)};
  if (palette.empty()) return loaded;
  for (auto& warning : checkMap(rows, map.string(), labels, palette.string()))
    loaded.warnings.push_back(std::move(warning));
  return loaded;
}

}  // namespace vismem
