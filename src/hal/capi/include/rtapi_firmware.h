/* Files of /lib/firmware, read whole. */
#ifndef RTAPI_FIRMWARE_H
#define RTAPI_FIRMWARE_H

#include <stddef.h>

#include <rtapi_device.h>
#include <rtapi_stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct rtapi_firmware {
  size_t size;
  const rtapi_u8* data;
};

/* 0, or a negative errno (-ENOENT). Not for realtime functions. */
extern int rtapi_request_firmware(const struct rtapi_firmware** fw, const char* name,
                                  struct rtapi_device* device);
extern void rtapi_release_firmware(const struct rtapi_firmware* fw);

#ifdef __cplusplus
}
#endif

#endif
