#include "localization/core/hypotheses/race_table.h"

#include <algorithm>

namespace vismem {

void RaceTable::age() {
  for (Race& race : races_) {
    ++race.age;
    ++race.since_best;
  }
}

RaceTable::Admission RaceTable::admit(Race candidate) {
  for (Race& race : races_) {
    if (samePlace(race.T_world_robot, candidate.T_world_robot, params_)) {
      ++race.age;
      return Admission::kAged;
    }
  }
  if (candidate.health < params_.create_health) return Admission::kIgnored;
  candidate.id = next_id_;
  if (!isFull()) {
    ++next_id_;
    races_.push_back(std::move(candidate));
    return Admission::kCreated;
  }
  Race* victim = nullptr;
  for (Race& race : races_) {
    if (isProtected(race) || !isReplaceable(race, candidate.health)) continue;
    if (race.evidence > candidate.evidence + params_.protected_log_odds) continue;
    if (!victim || race.health < victim->health) victim = &race;
  }
  if (!victim) return Admission::kIgnored;
  ++next_id_;
  *victim = std::move(candidate);
  forgetMissingWinner();
  return Admission::kReplaced;
}

bool RaceTable::mayAdmit(const Race& candidate, double most_health) const {
  if (candidate.health < params_.create_health) return false;
  for (const Race& race : races_) {
    // Another candidate may replace that race first, after aging it enough.
    if (samePlace(race.T_world_robot, candidate.T_world_robot, params_))
      return isReplaceable(race, most_health);
  }
  // A race that another candidate puts in a place is healthier than the replaced one.
  return !isFull() || std::any_of(races_.begin(), races_.end(),
                                  [&](const Race& race) { return isReplaceable(race, candidate.health); });
}

void RaceTable::replaceAll(Race race) {
  races_.clear();
  race.id = winner_ = next_id_++;
  races_.push_back(std::move(race));
}

void RaceTable::prune(double spared_evidence) {
  std::erase_if(races_, [&](const Race& race) {
    return !isProtected(race) && race.victories == 0 && race.health < params_.delete_health &&
           race.evidence < spared_evidence;
  });
  forgetMissingWinner();
}

void RaceTable::mergeSamePlaces() {
  const auto isWeaker = [](const Race& a, const Race& b) {
    return a.victories != b.victories ? a.victories < b.victories : a.health < b.health;
  };
  for (std::size_t i = 0; i < races_.size(); ++i) {
    for (std::size_t j = i + 1; j < races_.size();) {
      if (!samePlace(races_[i].T_world_robot, races_[j].T_world_robot, params_)) {
        ++j;
        continue;
      }
      const bool first_goes = isWeaker(races_[i], races_[j]);
      // The survivor of the same place stays the winner.
      const std::uint64_t gone = first_goes ? races_[i].id : races_[j].id;
      if (first_goes) std::swap(races_[i], races_[j]);
      if (winner_ == gone) winner_ = races_[i].id;
      races_.erase(races_.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;
    }
  }
}

void RaceTable::award(std::uint64_t id) {
  for (Race& race : races_) {
    const int change = race.id == id ? 1 : -1;
    race.victories = std::clamp(race.victories + change, 0, params_.maximum_victories);
  }
}

void RaceTable::recordBest(std::uint64_t id) {
  for (Race& race : races_) {
    if (race.id == id) race.since_best = 0;
  }
}

bool RaceTable::isProtected(const Race& race) const {
  return race.age < params_.protected_age || race.since_best < params_.protected_after_best;
}

const Race* RaceTable::find(std::uint64_t id) const {
  for (const Race& race : races_) {
    if (race.id == id) return &race;
  }
  return nullptr;
}

const Race* RaceTable::healthiest() const {
  const auto best = std::max_element(races_.begin(), races_.end(),
                                     [](const Race& a, const Race& b) { return a.health < b.health; });
  return best == races_.end() ? nullptr : &*best;
}

const Race* RaceTable::mostVictories() const {
  const Race* best = nullptr;
  for (const Race& race : races_) {
    if (!best || race.victories > best->victories) {
      best = &race;
    } else if (race.victories == best->victories && best->id != winner_ &&
               (race.id == winner_ || race.health > best->health)) {
      best = &race;
    }
  }
  return best;
}

void RaceTable::clear() {
  races_.clear();
  winner_ = 0;
}

void RaceTable::forgetMissingWinner() {
  if (!find(winner_)) winner_ = 0;
}

void selectByVictories(RaceTable& table, double lead) {
  const Race* healthiest = table.healthiest();
  if (!healthiest) return;
  const Race* chosen = table.winner();
  const std::uint64_t best = healthiest->id;
  if (!chosen || chosen->id == best || healthiest->health - chosen->health > lead) table.award(best);
  table.recordBest(best);
  table.setWinner(table.mostVictories()->id);
}

}  // namespace vismem
