#include "localization/app/retired_keys.h"

namespace vismem {
namespace {

constexpr const char* kFixed = "its value is fixed by the mode";
constexpr const char* kGone = "the part that it belonged to is gone";

}  // namespace

void acceptRetiredLocalizationKeys(ConfigReader& reader) {
  reader.group("Races").retired(
      "SamePlace_m SamePlace_deg CreateHealth DeleteHealth ProtectedLogOdds ProtectedAge "
      "ProtectedAfterBest MaximumVictories SparedAhead",
      kFixed);
  reader.group("Explorers")
      .retired("ReliableAbove ListHealth CountLost CountReliable PeriodReliable Candidates Margin_m", kFixed);
  reader.group("Evolution").retired("Elitism Crossover Noise_m Noise_deg Individuals", kFixed);
  reader.group("Health").retired(
      "UseField MemoryScale_m ImageScale_px MemoryRange_m GridTop_px GridBottom_px", kFixed);
  reader.group("Robust").retired(
      "MemoryBelow_points ImageRange_m PointStep_m Range_m UnconfirmedWeight EffectivePoints "
      "EndMetres PointsPerMetre MaximumSigma_m MaximumPoints Bounded DirectionGate "
      "DirectionGate_deg UseField Kalman RefinementSteps DeleteBehind ConstructedShare "
      "UniformArea_m2 RefinedExplorers Validity ReliabilityTime_s EnoughPoints ExplainedLow "
      "ExplainedHigh Source CameraTilt.Bias_deg LeanBias_deg",
      kFixed);
  reader.group("Robust").retired(
      "HalfNoveltyViews Repeats NoveltyShare NewsShare NoveltyDecay_s RepeatTime_s "
      "LandmarkShare Corners Doors Parallelograms KldError KldPlace_m KldPlace_deg KldLeast "
      "NegativeInformation DetectionProbability RateAtImageStamp",
      kGone);
  reader.group("Odometry").retired("Calibrate Learn", "each hypothesis estimates the errors of odometry");
  reader.group("Odometry")
      .retired(
          "Turn_degpm TurnShare TravelShare WalkShare Piece_m Piece_deg Pose_m Pose_deg Noise_deg "
          "TurnNoise Noise_m GateSigmas Trust",
          kFixed);
  reader.retired("SuspectTick_s SuspectTime_s DoubtTick_s Doubt_s", kGone);
  reader.retired("Cell_m", kFixed);
  reader.group("Gaze").retired(
      "LeastPriority MostPriority Confirm_s Deadline_s Seen_deg Move_deg Pan.Minimum_deg Pan.Maximum_deg "
      "Tilt.Minimum_deg "
      "Tilt.Maximum_deg Step_deg Range_m Sigma_m NoneShare Horizon_s Patience_s HalfNovelty_s "
      "Forget_s HeadSpeed_degps HeadAcceleration_degps2 Delay_s Repeat_s",
      kFixed);
}

}  // namespace vismem
