#include "hwkernel/guest.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "support/build_paths.h"
#include "support/eventually.h"
#include "support/free_ports.h"

namespace vismem {
namespace {

/// On a busy machine the boot takes four times what it takes on an idle one.
constexpr std::chrono::seconds kBoot{60};
constexpr std::chrono::seconds kCommand{60};

std::string readAll(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

Guest::Guest(const std::string& boot, const std::vector<int>& ports) {
  writeFile("agent", readAll(VISMEM_SOURCE_DIR "/test/hwkernel/agent"));
  std::string network = "user,id=n";
  const int offset = freePortOffset();
  for (const int port : ports) {
    ports_[port] = port + offset;
    network += ",hostfwd=tcp:127.0.0.1:" + std::to_string(port + offset) + "-:" + std::to_string(port);
  }
  machine_ = std::make_unique<ChildProcess>(
      std::vector<std::string>{"qemu-system-x86_64",
                               "-M",
                               "q35",
                               "-accel",
                               "tcg,thread=multi",
                               "-cpu",
                               "max",
                               "-m",
                               "1024",
                               "-smp",
                               "2",
                               "-nographic",
                               "-nodefaults",
                               "-no-reboot",
                               "-serial",
                               "stdio",
                               "-kernel",
                               boot + "/vmlinuz",
                               "-initrd",
                               boot + "/initrd.gz",
                               "-append",
                               "console=ttyS0 quiet panic=-1",
                               "-fsdev",
                               "local,id=h,path=/,security_model=none,readonly=on,multidevs=remap",
                               "-device",
                               "virtio-9p-pci,fsdev=h,mount_tag=host",
                               "-fsdev",
                               "local,id=s,path=" + shared_.path().string() + ",security_model=none",
                               "-device",
                               "virtio-9p-pci,fsdev=s,mount_tag=scratch",
                               "-netdev",
                               network,
                               "-device",
                               "virtio-net-pci,netdev=n,romfile="});
}

bool Guest::waitUntilReady() const {
  return eventually([&] { return std::filesystem::exists(file("ready")) || !machine_->running(); }, kBoot) &&
         machine_->running();
}

std::string Guest::file(const std::string& name) const {
  return (shared_.path() / name).string();
}

void Guest::writeFile(const std::string& name, const std::string& content) const {
  std::ofstream(file(name + ".writing"), std::ios::binary) << content;
  std::filesystem::rename(file(name + ".writing"), file(name));
}

Guest::Result Guest::run(const std::string& command) {
  const std::string name = std::to_string(commands_++);
  writeFile(name, command + "\n");
  Result result;
  if (eventually([&] { return std::filesystem::exists(file(name + ".done")); }, kCommand)) {
    result.code = std::stoi(readAll(file(name + ".done")));
  }
  result.output = readAll(file(name + ".out"));
  return result;
}

}  // namespace vismem
