/* A device as drivers register it: a name, and what to do when it goes. */
#ifndef RTAPI_DEVICE_H
#define RTAPI_DEVICE_H

#include <stdarg.h>
#include <stdio.h>

struct rtapi_device {
  char name[48];
  void (*release)(struct rtapi_device*);
};

static inline int rtapi_dev_set_name(struct rtapi_device* dev, const char* name, ...) {
  va_list args;
  va_start(args, name);
  vsnprintf(dev->name, sizeof dev->name, name, args);
  va_end(args);
  return 0;
}
static inline const char* rtapi_dev_name(const struct rtapi_device* dev) { return dev->name; }
static inline int rtapi_device_register(struct rtapi_device* dev) {
  (void)dev;
  return 0;
}
static inline void rtapi_device_unregister(struct rtapi_device* dev) {
  if (dev->release) dev->release(dev);
}

#endif
