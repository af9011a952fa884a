/* A counter card: quadrature decoding in the fast function, velocity and index in the slow one. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

#include "rtapi_math.h"
MODULE_LICENSE("GPL");
static int num_chan = 1;
RTAPI_MP_INT(num_chan, "channels");
typedef struct {
    hal_bit_t *a, *b, *z, *index_enable, *reset;
    hal_s32_t *count, *rawcount;
    hal_float_t *position, *velocity;
    hal_float_t scale;
    hal_bit_t x4;
    unsigned char state;
    int raw, offset, last;
    hal_bit_t old_z;
} counter_t;
static counter_t *counters;
static int comp_id;
static const signed char table[16] = {0, 1, -1, 0, -1, 0, 0, 1, 1, 0, 0, -1, 0, -1, 1, 0};

static void update(void *arg, long period)
{
    int i;
    counter_t *c = arg;
    (void)period;
    for (i = 0; i < num_chan; i++, c++) {
        c->state = (c->state << 2 | (*c->b ? 2 : 0) | (*c->a ? 1 : 0)) & 15;
        c->raw += table[c->state];
        if (*c->z && !c->old_z && *c->index_enable) { c->offset = c->raw; *c->index_enable = 0; }
        c->old_z = *c->z;
        *c->rawcount = c->raw;
    }
}
static void capture(void *arg, long period)
{
    int i;
    counter_t *c = arg;
    for (i = 0; i < num_chan; i++, c++) {
        if (*c->reset) c->offset = c->raw;
        *c->count = c->raw - c->offset;
        if (fabs(c->scale) < 1e-9) c->scale = 1.0;
        *c->position = *c->count / c->scale;
        *c->velocity = (c->raw - c->last) / c->scale / (period * 1e-9);
        c->last = c->raw;
    }
}
int rtapi_app_main(void)
{
    int i, r = 0;
    if (num_chan < 1 || num_chan > 8) return -EINVAL;
    comp_id = hal_init("vd_counter");
    if (comp_id < 0) return comp_id;
    counters = hal_malloc(num_chan * sizeof(counter_t));
    if (!counters) { hal_exit(comp_id); return -ENOMEM; }
    memset(counters, 0, num_chan * sizeof(counter_t));
    for (i = 0; i < num_chan && r == 0; i++) {
        counter_t *c = &counters[i];
        r = hal_pin_bit_newf(HAL_IN, &c->a, comp_id, "vd-counter.%d.phase-A", i);
        r = r ? r : hal_pin_bit_newf(HAL_IN, &c->b, comp_id, "vd-counter.%d.phase-B", i);
        r = r ? r : hal_pin_bit_newf(HAL_IN, &c->z, comp_id, "vd-counter.%d.phase-Z", i);
        r = r ? r : hal_pin_bit_newf(HAL_IN, &c->reset, comp_id, "vd-counter.%d.reset", i);
        r = r ? r : hal_pin_bit_newf(HAL_IO, &c->index_enable, comp_id, "vd-counter.%d.index-enable", i);
        r = r ? r : hal_pin_s32_newf(HAL_OUT, &c->count, comp_id, "vd-counter.%d.count", i);
        r = r ? r : hal_pin_s32_newf(HAL_OUT, &c->rawcount, comp_id, "vd-counter.%d.rawcount", i);
        r = r ? r : hal_pin_float_newf(HAL_OUT, &c->position, comp_id, "vd-counter.%d.position", i);
        r = r ? r : hal_pin_float_newf(HAL_OUT, &c->velocity, comp_id, "vd-counter.%d.velocity", i);
        r = r ? r : hal_param_float_newf(HAL_RW, &c->scale, comp_id, "vd-counter.%d.scale", i);
        r = r ? r : hal_param_bit_newf(HAL_RW, &c->x4, comp_id, "vd-counter.%d.x4-mode", i);
        c->scale = 100.0;
    }
    r = r ? r : hal_export_funct("vd-counter.update", update, counters, 0, 0, comp_id);
    r = r ? r : hal_export_funct("vd-counter.capture", capture, counters, 1, 0, comp_id);
    if (r) { hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
