#include "common/robot_ice/remote.h"

#include <jderobot/exceptions.h>

#include "common/process/ice_failure.h"

namespace vismem {

std::string reasonOf(const Ice::ObjectPrx& proxy, const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const avm::Failure& failure) {
    return failure.reason;
  } catch (const jderobot::JderobotException& failure) {
    return failure.what;
  } catch (const Ice::InvocationTimeoutException&) {
    return "no answer within " + std::to_string(proxy.ice_getInvocationTimeout()) + " ms";
  } catch (const std::exception& failure) {
    return describeFailure(failure);
  }
}

std::string describeFailure(const Ice::ObjectPrx& proxy, const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const Ice::UserException&) {
    return reasonOf(proxy, error);  // The peer's own answer.
  } catch (...) {
    return proxyText(proxy) + ": " + reasonOf(proxy, error);
  }
}

void leaveIfSilent(Ice::Connection& connection, const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const Ice::InvocationTimeoutException&) {
    connection.close(Ice::ConnectionClose::Forcefully);
  } catch (...) {
    // Any other failure has ended the connection, or does not concern it.
  }
}

}  // namespace vismem
