#include "support/emulated_node.h"

#include <sys/ioctl.h>
#include <umockdev.h>

#include <atomic>
#include <cerrno>
#include <mutex>
#include <stdexcept>
#include <utility>

namespace vismem {

struct EmulatedNode::State {
  Description description;
  Handler handler;
  UMockdevTestbed* testbed = nullptr;
  UMockdevIoctlBase* object = nullptr;
  std::atomic<bool> plugged = false;
  std::mutex answering;  ///< an unplug waits for the answer that is being given
  bool attached = false;
};

namespace {

/// The handler of a node's ioctls, as a GObject. Open descriptors of the node keep it alive: then the state
/// must outlive the node.
struct Object {
  UMockdevIoctlBase parent;
  std::shared_ptr<EmulatedNode::State>* state;
};
struct ObjectClass {
  UMockdevIoctlBaseClass parent;
};

gboolean handleIoctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client) {
  EmulatedNode::State& state = **reinterpret_cast<Object*>(base)->state;
  const auto code = static_cast<unsigned>(umockdev_ioctl_client_get_request(client) & 0xFFFFFFFFU);
  IoctlAnswer answer = IoctlAnswer::failed(ENODEV);
  {
    const std::lock_guard lock(state.answering);
    if (state.plugged) {
      const IoctlMemory pointer(g_object_ref(umockdev_ioctl_client_get_arg(client)));
      try {
        answer = state.handler(code, [&](std::size_t size) { return pointer.at(0, size); });
      } catch (const std::runtime_error&) {
        // Memory that cannot be read: the process that asked was killed meanwhile, or gave a wrong address.
        answer = IoctlAnswer::failed(EFAULT);
      }
    }
  }
  umockdev_ioctl_client_complete(client, answer.result, answer.error);
  return TRUE;
}

gpointer parent_class = nullptr;

void finalise(GObject* object) {
  delete reinterpret_cast<Object*>(object)->state;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

void initialiseClass(gpointer handlers, gpointer) {
  parent_class = g_type_class_peek_parent(handlers);
  G_OBJECT_CLASS(handlers)->finalize = finalise;
  static_cast<ObjectClass*>(handlers)->parent.handle_ioctl = handleIoctl;
}

GType objectType() {
  static const GType type =
      g_type_register_static_simple(UMOCKDEV_TYPE_IOCTL_BASE, "VismemIoctlHandler", sizeof(ObjectClass),
                                    initialiseClass, sizeof(Object), nullptr, G_TYPE_FLAG_NONE);
  return type;
}

/// There to the end of the process: its thread answers the requests of all nodes, and who asks while it ends
/// waits for ever.
UMockdevTestbed* sharedTestbed() {
  static const std::unique_ptr<UMockdevTestbed, decltype(&g_object_unref)> testbed(umockdev_testbed_new(),
                                                                                   g_object_unref);
  return testbed.get();
}

void check(GError* error) {
  if (error == nullptr) return;
  const std::string what = error->message;
  g_error_free(error);
  throw std::runtime_error("umockdev: " + what);
}

UMockdevIoctlData* dataOf(void* data) {
  return static_cast<UMockdevIoctlData*>(data);
}

}  // namespace

IoctlMemory::IoctlMemory(void* data) : data_(data) {}
IoctlMemory::IoctlMemory(const IoctlMemory& other) : data_(g_object_ref(other.data_)) {}
IoctlMemory::~IoctlMemory() {
  g_object_unref(data_);
}
std::uint8_t* IoctlMemory::bytes() const {
  return dataOf(data_)->data;
}
std::size_t IoctlMemory::size() const {
  return static_cast<std::size_t>(dataOf(data_)->data_len);
}
std::uint64_t IoctlMemory::address() const {
  return dataOf(data_)->client_addr;
}
IoctlMemory IoctlMemory::at(std::size_t offset, std::size_t size) const {
  GError* error = nullptr;
  UMockdevIoctlData* data =
      umockdev_ioctl_data_resolve(dataOf(data_), static_cast<gint>(offset), static_cast<gint>(size), &error);
  check(error);
  return IoctlMemory(data);
}
void IoctlMemory::commit() const {
  umockdev_ioctl_data_update(dataOf(data_), 0, bytes(), static_cast<gint>(size()));
}

EmulatedNode::EmulatedNode(Description description, Handler handler) : state_(std::make_shared<State>()) {
  state_->description = std::move(description);
  state_->handler = std::move(handler);
  state_->testbed = sharedTestbed();
  // Only a testbed shows whether it is present.
  if (umockdev_in_mock_environment() == FALSE) {
    throw std::runtime_error("not under umockdev: run this test by ctest, or behind umockdev-wrapper");
  }
  auto* object = static_cast<Object*>(g_object_new(objectType(), nullptr));
  object->state = new std::shared_ptr<State>(state_);
  state_->object = &object->parent;
}

EmulatedNode::~EmulatedNode() {
  unplug();
  if (state_->attached) {
    umockdev_testbed_detach_ioctl(state_->testbed, state_->description.node.c_str(), nullptr);
  }
  g_object_unref(state_->object);
}

void EmulatedNode::plugIn() {
  if (state_->plugged) return;
  GError* error = nullptr;
  UMockdevTestbed* const testbed = state_->testbed;
  const Description& description = state_->description;
  if (state_->attached) umockdev_testbed_detach_ioctl(testbed, description.node.c_str(), nullptr);
  umockdev_testbed_add_from_string(testbed, description.text.c_str(), &error);
  check(error);
  umockdev_testbed_attach_ioctl(testbed, description.node.c_str(), state_->object, &error);
  check(error);
  state_->attached = true;
  state_->plugged = true;
}

void EmulatedNode::unplug() {
  {
    const std::lock_guard lock(state_->answering);
    if (!state_->plugged.exchange(false)) return;
  }
  umockdev_testbed_uevent(state_->testbed, state_->description.device.c_str(), "remove");
  umockdev_testbed_remove_device(state_->testbed, state_->description.device.c_str());
}

bool EmulatedNode::plugged() const {
  return state_->plugged;
}

std::string EmulatedNode::realPath() const {
  gchar* const root = umockdev_testbed_get_root_dir(state_->testbed);
  std::string path = root + state_->description.node;
  g_free(root);
  return path;
}

}  // namespace vismem
