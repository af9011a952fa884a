/* Parallel ports by their I/O addresses. */
#ifndef RTAPI_PARPORT_H
#define RTAPI_PARPORT_H

#define PARPORT_MODE_PCSPP (1 << 0)
#define PARPORT_MODE_TRISTATE (1 << 1)
#define PARPORT_MODE_EPP (1 << 2)
#define PARPORT_MODE_ECP (1 << 3)
#define PARPORT_MODE_COMPAT (1 << 4)
#define PARPORT_MODE_DMA (1 << 5)
#define PARPORT_MODE_SAFEININT (1 << 6)

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rtapi_parport_t {
  unsigned short base;
  unsigned short base_hi; /* 0: none */
  int dev_fd;             /* -1, or the ppdev device that is claimed */
} rtapi_parport_t;

/* `base` below 16 is a Linux port number, else an address. `base_hi` 0: as Linux knows it or base + 0x400; 0xffff: none.
   0, or a negative errno: -ENODEV no such port, -EBUSY claimed by another driver, -EPERM no right to the addresses. */
extern int rtapi_parport_get(const char* module_name, rtapi_parport_t* port, unsigned short base,
                             unsigned short base_hi, unsigned int modes);
extern void rtapi_parport_release(rtapi_parport_t* port);

#ifdef __cplusplus
}
#endif

#endif
