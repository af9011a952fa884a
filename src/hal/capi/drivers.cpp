// What drivers of boards use: rights to ports, programs, firmware, PCI, parallel ports. Only at load time, never realtime.
#include <fcntl.h>
#include <rtapi.h>
#include <rtapi_firmware.h>
#include <rtapi_io.h>
#include <rtapi_parport.h>
#include <rtapi_pci.h>
#include <spawn.h>
#include <sys/io.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <linux/ppdev.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hal/capi/messages.hpp"

namespace kerf::hal::capi {
void grant_ports(unsigned long from, unsigned long count, bool on) noexcept;

namespace {
bool have_port_rights = false;
}

/// The kernel keeps rights to ports by thread, and threads inherit them: they are taken before any realtime thread is made, for
/// all ports. What modules have asked for is counted by grant_ports().
void acquire_port_rights() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  have_port_rights = ::iopl(3) == 0;
#endif
}

}  // namespace kerf::hal::capi

using kerf::hal::capi::grant_ports;
using kerf::hal::capi::have_port_rights;
using kerf::hal::capi::say;

namespace {

const std::string pci_devices = "/sys/bus/pci/devices/";

/// The first line of a file of /sys or /proc; empty when it cannot be read.
std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}
unsigned long number_in(const std::string& path) {
  return std::strtoul(first_line(path).c_str(), nullptr, 0);
}

struct Board {
  rtapi_pci_dev dev{};
  rtapi_pci_driver* driver{nullptr};
};
std::list<std::unique_ptr<Board>> boards;
std::map<void*, std::size_t> mappings;  ///< BARs, and their sizes

bool fits(rtapi_u32 wanted, rtapi_u32 is) { return wanted == RTAPI_PCI_ANY_ID || wanted == is; }

rtapi_pci_dev read_board(const std::string& name) {
  rtapi_pci_dev dev{};
  std::snprintf(dev.dev_name, sizeof dev.dev_name, "%s", name.c_str());
  const std::string folder = pci_devices + name + "/";
  dev.vendor = static_cast<rtapi_u16>(number_in(folder + "vendor"));
  dev.device = static_cast<rtapi_u16>(number_in(folder + "device"));
  dev.subsystem_vendor = static_cast<rtapi_u16>(number_in(folder + "subsystem_vendor"));
  dev.subsystem_device = static_cast<rtapi_u16>(number_in(folder + "subsystem_device"));
  std::ifstream resources(folder + "resource");
  std::string line;
  for (auto& resource : dev.resource) {
    if (!std::getline(resources, line)) break;
    (void)std::sscanf(line.c_str(), "%lx %lx %lx", &resource.start, &resource.end, &resource.flags);
  }
  return dev;
}

/// Base addresses that Linux knows for parport N: "888\t1912".
bool linux_parport(unsigned number, unsigned short& base, unsigned short& base_hi) {
  const std::string line =
      first_line("/proc/sys/dev/parport/parport" + std::to_string(number) + "/base-addr");
  unsigned low = 0, high = 0;
  if (std::sscanf(line.c_str(), "%u %u", &low, &high) < 1) return false;
  base = static_cast<unsigned short>(low);
  base_hi = static_cast<unsigned short>(high);
  return true;
}

/// The Linux number of the port at an address, or -1.
int parport_number(unsigned short base) {
  for (unsigned i = 0; i < 16; ++i) {
    unsigned short low = 0, high = 0;
    if (linux_parport(i, low, high) && low == base) return static_cast<int>(i);
  }
  return -1;
}

/// Claims a port that Linux has. The descriptor, -1 when there is no driver for it, or -EBUSY.
int claim_ppdev(int number) {
  const std::string path = "/dev/parport" + std::to_string(number);
  const int fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (fd < 0) return -1;
  if (::ioctl(fd, PPEXCL) < 0 || ::ioctl(fd, PPCLAIM) < 0) {
    ::close(fd);
    return -EBUSY;
  }
  return fd;
}

}  // namespace

extern "C" {

int rtapi_ioperm(unsigned long from, unsigned long num, int turn_on) {
  if (!have_port_rights) {
    errno = EPERM;
    return -1;
  }
  grant_ports(from, num, turn_on != 0);
  return 0;
}

// ---- programs and files --------------------------------------------------------------------------

int rtapi_spawn_as_root(int* pid, const char* path, const void* file_actions,
                        const void* attributes, char* const argv[], char* const envp[]) {
  return ::posix_spawn(pid, path, static_cast<const posix_spawn_file_actions_t*>(file_actions),
                       static_cast<const posix_spawnattr_t*>(attributes), argv, envp);
}
int rtapi_spawnp_as_root(int* pid, const char* file, const void* file_actions,
                         const void* attributes, char* const argv[], char* const envp[]) {
  return ::posix_spawnp(pid, file, static_cast<const posix_spawn_file_actions_t*>(file_actions),
                        static_cast<const posix_spawnattr_t*>(attributes), argv, envp);
}
int rtapi_open_as_root(const char* filename, int flags) {
  const int fd = ::open(filename, flags | O_CLOEXEC);  // NOLINT(cppcoreguidelines-pro-type-vararg)
  return fd >= 0 ? fd : -errno;
}

// ---- firmware ------------------------------------------------------------------------------------

int rtapi_request_firmware(const struct rtapi_firmware** fw, const char* name,
                           struct rtapi_device* /*device*/) {
  *fw = nullptr;
  const std::string path = std::string("/lib/firmware/") + name;
  if (std::string(name).find("..") != std::string::npos) return -EINVAL;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    say(RTAPI_MSG_ERR, "RTAPI: ERROR: firmware %s cannot be read\n", path.c_str());
    return -ENOENT;
  }
  const std::string content((std::istreambuf_iterator<char>(file)),
                            std::istreambuf_iterator<char>());
  auto* made = static_cast<rtapi_firmware*>(std::malloc(sizeof(rtapi_firmware) + content.size()));
  if (made == nullptr) return -ENOMEM;
  auto* data = reinterpret_cast<rtapi_u8*>(made + 1);
  std::memcpy(data, content.data(), content.size());
  made->size = content.size();
  made->data = data;
  *fw = made;
  return 0;
}

void rtapi_release_firmware(const struct rtapi_firmware* fw) {
  std::free(const_cast<rtapi_firmware*>(fw));
}

// ---- PCI -----------------------------------------------------------------------------------------

int rtapi_pci_enable_device(struct rtapi_pci_dev* dev) {
  std::ofstream enable(pci_devices + dev->dev_name + "/enable");
  enable << "1" << std::flush;
  return enable ? 0 : -EPERM;
}

int rtapi_pci_disable_device(struct rtapi_pci_dev* dev) {
  std::ofstream enable(pci_devices + dev->dev_name + "/enable");
  enable << "0" << std::flush;
  return enable ? 0 : -EPERM;
}

void* rtapi_pci_ioremap_bar(struct rtapi_pci_dev* dev, int bar) {
  if (bar < 0 || bar >= RTAPI_PCI_NUM_RESOURCES) return nullptr;
  const std::string path = pci_devices + dev->dev_name + "/resource" + std::to_string(bar);
  const int fd = ::open(path.c_str(), O_RDWR | O_SYNC | O_CLOEXEC);
  struct stat info {};
  if (fd < 0 || ::fstat(fd, &info) != 0 || info.st_size <= 0) {
    say(RTAPI_MSG_ERR, "RTAPI: ERROR: %s cannot be opened: %s\n", path.c_str(),
        std::strerror(errno));
    if (fd >= 0) ::close(fd);
    return nullptr;
  }
  const auto size = static_cast<std::size_t>(info.st_size);
  void* base = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  ::close(fd);
  if (base == MAP_FAILED) return nullptr;
  mappings[base] = size;
  dev->resource[bar].mmap_base = base;
  return base;
}

void rtapi_iounmap(volatile void* addr) {
  void* base = const_cast<void*>(addr);
  const auto it = mappings.find(base);
  if (it == mappings.end()) return;
  ::munmap(base, it->second);
  mappings.erase(it);
}

int rtapi_pci_register_driver(struct rtapi_pci_driver* driver) {
  std::error_code error;
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator it(pci_devices, error), end; !error && it != end;
       it.increment(error)) {
    names.push_back(it->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  for (const auto& name : names) {
    auto board = std::make_unique<Board>();
    board->dev = read_board(name);
    board->driver = driver;
    for (const auto* id = driver->id_table; id->vendor != 0 || id->device != 0; ++id) {
      if (!fits(id->vendor, board->dev.vendor) || !fits(id->device, board->dev.device) ||
          !fits(id->subvendor, board->dev.subsystem_vendor) ||
          !fits(id->subdevice, board->dev.subsystem_device)) {
        continue;
      }
      if (driver->probe(&board->dev, id) >= 0) boards.push_back(std::move(board));
      break;
    }
  }
  return 0;
}

void rtapi_pci_unregister_driver(struct rtapi_pci_driver* driver) {
  for (auto it = boards.begin(); it != boards.end();) {
    if ((*it)->driver != driver) {
      ++it;
      continue;
    }
    if (driver->remove != nullptr) driver->remove(&(*it)->dev);
    it = boards.erase(it);
  }
}

// ---- parallel ports ------------------------------------------------------------------------------

int rtapi_parport_get(const char* module_name, rtapi_parport_t* port, unsigned short base,
                      unsigned short base_hi, unsigned int /*modes*/) {
  constexpr unsigned short kNoHigh = 0xffff;
  constexpr unsigned short kHighAbove = 0x400;
  *port = {};
  port->dev_fd = -1;
  const char* who = module_name == nullptr ? "driver" : module_name;
  unsigned short known_hi = 0;
  int number = base < 16 ? base : parport_number(base);
  if (base < 16) {
    if (!linux_parport(base, port->base, known_hi)) {
      say(RTAPI_MSG_ERR, "%s: ERROR: Linux has no parallel port %d\n", who, base);
      return -ENODEV;
    }
  } else {
    port->base = base;
  }
  if (base_hi == 0)
    port->base_hi = known_hi != 0 ? known_hi : static_cast<unsigned short>(port->base + kHighAbove);
  else if (base_hi != kNoHigh)
    port->base_hi = base_hi;
  if (number >= 0) {
    const int fd = claim_ppdev(number);
    if (fd == -EBUSY) {
      say(RTAPI_MSG_ERR, "%s: ERROR: parallel port %d is claimed by another driver\n", who, number);
      return -EBUSY;
    }
    port->dev_fd = fd;
  }
  if (rtapi_ioperm(port->base, 8, 1) != 0 ||
      (port->base_hi != 0 && rtapi_ioperm(port->base_hi, 3, 1) != 0)) {
    say(RTAPI_MSG_ERR, "%s: ERROR: no right to I/O ports from 0x%x: %s\n", who, port->base,
        std::strerror(errno));
    rtapi_parport_release(port);
    return -EPERM;
  }
  return 0;
}

void rtapi_parport_release(rtapi_parport_t* port) {
  if (port->base != 0) (void)rtapi_ioperm(port->base, 8, 0);
  if (port->base_hi != 0) (void)rtapi_ioperm(port->base_hi, 3, 0);
  if (port->dev_fd >= 0) ::close(port->dev_fd);
  *port = {};
  port->dev_fd = -1;
}

}  // extern "C"
