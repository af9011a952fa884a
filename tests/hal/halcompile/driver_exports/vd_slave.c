/* A slave on the bus. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

MODULE_LICENSE("GPL");
extern int vd_bus_register(const char *name);
extern int vd_bus_transfer(int slave, unsigned char out);
static int comp_id, slave;
typedef struct { hal_bit_t *out[8], *in[8], *in_not[8]; hal_s32_t *error; } slave_t;
static slave_t *s;
static void cycle(void *arg, long period)
{
    int i, got;
    unsigned char byte = 0;
    (void)arg; (void)period;
    for (i = 0; i < 8; i++) byte |= (*s->out[i] ? 1 : 0) << i;
    got = vd_bus_transfer(slave, byte);
    *s->error = got < 0 ? got : 0;
    for (i = 0; got >= 0 && i < 8; i++) { *s->in[i] = got >> i & 1; *s->in_not[i] = !*s->in[i]; }
}
int rtapi_app_main(void)
{
    int i, r = 0;
    slave = vd_bus_register("slave");
    if (slave < 0) return slave;
    comp_id = hal_init("vd_slave");
    if (comp_id < 0) return comp_id;
    s = hal_malloc(sizeof *s);
    if (!s) { hal_exit(comp_id); return -ENOMEM; }
    memset(s, 0, sizeof *s);
    for (i = 0; i < 8 && r == 0; i++) {
        r = hal_pin_bit_newf(HAL_IN, &s->out[i], comp_id, "vd-slave.%d.output-%02d", slave, i);
        if (r == 0) r = hal_pin_bit_newf(HAL_OUT, &s->in[i], comp_id, "vd-slave.%d.input-%02d", slave, i);
        if (r == 0) r = hal_pin_bit_newf(HAL_OUT, &s->in_not[i], comp_id, "vd-slave.%d.input-%02d-not", slave, i);
    }
    if (r == 0) r = hal_pin_s32_newf(HAL_OUT, &s->error, comp_id, "vd-slave.%d.error", slave);
    if (r == 0) r = hal_export_funct("vd-slave.0.cycle", cycle, s, 0, 0, comp_id);
    if (r < 0) { hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
