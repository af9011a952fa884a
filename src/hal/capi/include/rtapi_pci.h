/* PCI boards, by the files that Linux shows below /sys/bus/pci/devices. */
#ifndef RTAPI_PCI_H
#define RTAPI_PCI_H

#include <stddef.h>

#include <rtapi_device.h>
#include <rtapi_stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define rtapi__iomem
#define RTAPI_PCI_ANY_ID (~(rtapi_u32)0)
#define RTAPI_PCI_NUM_RESOURCES 6
#define RTAPI_IORESOURCE_IO 0x00000100UL
#define RTAPI_IORESOURCE_MEM 0x00000200UL

struct rtapi_pci_device_id {
  rtapi_u32 vendor, device;
  rtapi_u32 subvendor, subdevice;
  rtapi_u32 dev_class, class_mask;
};
struct rtapi_pci_resource {
  unsigned long start, end, flags;
  void* mmap_base;
};
struct rtapi_pci_dev {
  char dev_name[32]; /* "0000:05:00.0" */
  rtapi_u16 vendor, device;
  rtapi_u16 subsystem_vendor, subsystem_device;
  struct rtapi_pci_resource resource[RTAPI_PCI_NUM_RESOURCES];
  struct rtapi_device device_;
  void* driver_data;
};
struct rtapi_pci_driver {
  const char* name;
  const struct rtapi_pci_device_id* id_table; /* ends with an entry of zeros */
  int (*probe)(struct rtapi_pci_dev* dev, const struct rtapi_pci_device_id* id);
  void (*remove)(struct rtapi_pci_dev* dev);
  void* private_data;
};

static inline const char* rtapi_pci_name(const struct rtapi_pci_dev* dev) { return dev->dev_name; }
extern int rtapi_pci_enable_device(struct rtapi_pci_dev* dev);
extern int rtapi_pci_disable_device(struct rtapi_pci_dev* dev);
extern void rtapi__iomem* rtapi_pci_ioremap_bar(struct rtapi_pci_dev* dev, int bar);
extern void rtapi_iounmap(volatile void* addr);
/* Calls probe() for each board that a line of id_table fits. 0, or a negative errno. */
extern int rtapi_pci_register_driver(struct rtapi_pci_driver* driver);
extern void rtapi_pci_unregister_driver(struct rtapi_pci_driver* driver);
static inline void rtapi_pci_set_drvdata(struct rtapi_pci_dev* dev, void* data) {
  dev->driver_data = data;
}
static inline void* rtapi_pci_get_drvdata(struct rtapi_pci_dev* dev) { return dev->driver_data; }

#define rtapi_pci_resource_start(dev, bar) ((dev)->resource[bar].start)
#define rtapi_pci_resource_end(dev, bar) ((dev)->resource[bar].end)
#define rtapi_pci_resource_flags(dev, bar) ((dev)->resource[bar].flags)
#define rtapi_pci_resource_len(dev, bar)                                                    \
  (rtapi_pci_resource_start((dev), (bar)) == 0 && rtapi_pci_resource_end((dev), (bar)) == 0 \
       ? 0                                                                                  \
       : rtapi_pci_resource_end((dev), (bar)) - rtapi_pci_resource_start((dev), (bar)) + 1)

#ifdef __cplusplus
}
#endif

#endif
