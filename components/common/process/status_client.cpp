#include "common/process/status_client.h"

#include <avm/component.h>

#include <future>
#include <stdexcept>

#include "common/process/component_servant.h"
#include "common/process/ice_failure.h"

namespace vismem {
namespace {

std::shared_ptr<avm::ComponentPrx> componentAt(Ice::Communicator& communicator, const std::string& proxy,
                                               std::chrono::milliseconds timeout) {
  return Ice::uncheckedCast<avm::ComponentPrx>(
      communicator.stringToProxy(proxy)->ice_invocationTimeout(static_cast<int>(timeout.count())));
}

}  // namespace

std::vector<StatusAnswer> askStatus(Ice::Communicator& communicator, const std::vector<std::string>& proxies,
                                    std::chrono::milliseconds timeout) {
  std::vector<std::future<avm::ComponentStatus>> asked;
  for (const auto& proxy : proxies) {
    try {
      asked.push_back(componentAt(communicator, proxy, timeout)->getStatusAsync());
    } catch (...) {
      std::promise<avm::ComponentStatus> refused;
      refused.set_exception(std::current_exception());
      asked.push_back(refused.get_future());
    }
  }
  std::vector<StatusAnswer> answers;
  for (auto& answer : asked) {
    try {
      answers.push_back({fromSlice(answer.get()), ""});
    } catch (const Ice::ConnectFailedException& failure) {
      answers.push_back({std::nullopt, describeFailure(failure), true});
    } catch (const std::exception& failure) {
      answers.push_back({std::nullopt, describeFailure(failure)});
    }
  }
  return answers;
}

std::vector<Setting> askConfiguration(Ice::Communicator& communicator, const std::string& proxy,
                                      std::chrono::milliseconds timeout) {
  try {
    std::vector<Setting> settings;
    for (const auto& setting : componentAt(communicator, proxy, timeout)->getConfiguration()) {
      settings.push_back({setting.key, setting.value, ""});
    }
    return settings;
  } catch (const Ice::Exception& failure) {
    throw std::runtime_error(proxy + ": " + describeFailure(failure));
  }
}

}  // namespace vismem
