#include "common/robot_ice/remote.h"

#include <jderobot/exceptions.h>

namespace vismem {

std::string describeFailure(const Ice::ObjectPrx& proxy, const std::exception_ptr& error) {
  const std::string whom = proxy.ice_toString() + ": ";
  try {
    std::rethrow_exception(error);
  } catch (const avm::Failure& failure) {
    return failure.reason;
  } catch (const jderobot::JderobotException& failure) {
    return failure.what;
  } catch (const Ice::InvocationTimeoutException&) {
    return whom + "no answer within " + std::to_string(proxy.ice_getInvocationTimeout()) + " ms";
  } catch (const Ice::ConnectionRefusedException&) {
    return whom + "connection refused, nobody serves there";
  } catch (const Ice::ConnectionLostException&) {
    return whom + "connection lost";
  } catch (const Ice::CloseConnectionException&) {
    return whom + "the server closed the connection";
  } catch (const Ice::ObjectNotExistException&) {
    return whom + "the server has no object of this name";
  } catch (const Ice::OperationNotExistException& failure) {
    return whom + "the server does not know the operation " + failure.operation;
  } catch (const Ice::UnknownException& failure) {
    return whom + "the server failed: " + failure.unknown;
  } catch (const Ice::MemoryLimitException&) {
    return whom + "the answer is larger than Ice.MessageSizeMax allows";
  } catch (const Ice::Exception& failure) {
    return whom + failure.ice_id();
  } catch (const std::exception& failure) {
    return whom + failure.what();
  }
}

}  // namespace vismem
