/* Ports of the PC's I/O space. Without the right to a port (see rtapi_ioperm) a read gives all ones and a write does nothing; the
   first of either is reported. */
#ifndef RTAPI_IO_H
#define RTAPI_IO_H

#include <rtapi.h>

#ifdef __cplusplus
extern "C" {
#endif

extern unsigned short rtapi_inw(unsigned int port);
extern unsigned int rtapi_inl(unsigned int port);
extern void rtapi_outw(unsigned short value, unsigned int port);
extern void rtapi_outl(unsigned int value, unsigned int port);
/* As ioperm(2): 0, or -1 and errno. */
extern int rtapi_ioperm(unsigned long from, unsigned long num, int turn_on);

#ifdef __cplusplus
}
#endif

/* Nobody else hands out regions to programs: any is granted. */
#define rtapi_request_region(base, size, name) ((void*)1)
#define rtapi_release_region(base, size) ((void)0)

#endif
