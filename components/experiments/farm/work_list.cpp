#include "experiments/farm/work_list.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace vismem {

void WorkList::add(std::vector<Task> tasks) {
  for (Task& task : tasks) {
    if (std::find(known_.begin(), known_.end(), task.name) != known_.end()) continue;
    known_.push_back(task.name);
    queue_.push_back(task.name);
    open_.push_back({std::move(task)});
  }
}

std::optional<WorkList::Task> WorkList::take() {
  if (queue_.empty()) return std::nullopt;
  const std::string name = queue_.front();
  queue_.pop_front();
  return find(name).task;
}

void WorkList::keepParts(const std::string& name, std::string parts) {
  find(name).task.parts = std::move(parts);
}

void WorkList::finish(const std::string& name) {
  find(name);
  std::erase_if(open_, [&](const Open& one) { return one.task.name == name; });
  std::erase(queue_, name);
}

void WorkList::giveBack(const std::string& name) {
  find(name);
  queue_.push_front(name);
}

void WorkList::lose(const std::string& name) {
  Open& lost = find(name);
  ++losses_;
  if (++lost.losses >= kMostLosses) {
    throw std::runtime_error("task " + name + ": " + std::to_string(lost.losses) + " workers died of it");
  }
  queue_.push_front(name);
}

WorkList::Open& WorkList::find(const std::string& name) {
  const auto found =
      std::find_if(open_.begin(), open_.end(), [&](const Open& one) { return one.task.name == name; });
  if (found == open_.end()) throw std::invalid_argument("no open task \"" + name + "\"");
  return *found;
}

}  // namespace vismem
