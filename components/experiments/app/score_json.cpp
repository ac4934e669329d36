#include "experiments/app/score_json.h"

#include <nlohmann/json.hpp>

namespace vismem {

nlohmann::json toJson(const MemoryScore& score) {
  return {{"precision", score.precision()},
          {"recall", score.recall()},
          {"recall_resolved", score.recallResolved()},
          {"duplicates", score.duplicates()},
          {"right", score.right},
          {"partial", score.partial},
          {"false", score.wrong},
          {"unconfirmed", score.unconfirmed},
          {"unconfirmed_on_edges", score.unconfirmed_on_edges},
          {"shown", score.shown},
          {"found", score.found},
          {"shown_resolved", score.shown_resolved},
          {"found_resolved", score.found_resolved},
          {"right_m", score.right_m}};
}

}  // namespace vismem
