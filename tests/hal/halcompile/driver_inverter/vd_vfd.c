/* An inverter on a serial line: frames with a checksum, a ramp, a state machine, status bits. The line is looped back. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

MODULE_LICENSE("GPL");
enum { OFFLINE, READY, RUNNING, FAULT };
typedef struct {
    hal_float_t *speed_cmd, *speed_fb, *load;
    hal_bit_t *run, *reset, *at_speed, *fault, *comm_ok;
    hal_u32_t *status, *frames, *crc;
    hal_s32_t state;
    hal_float_t accel, limit;
    hal_u32_t period_count;
    unsigned char frame[8];
    double ramp;
    unsigned tick;
} vfd_t;
static vfd_t *v;
static int comp_id;
static unsigned crc16(const unsigned char *p, int n)
{
    unsigned crc = 0xffff;
    while (n--) {
        int i;
        crc ^= *p++;
        for (i = 0; i < 8; i++) crc = crc & 1 ? crc >> 1 ^ 0xa001 : crc >> 1;
    }
    return crc;
}
static void frame(int hz)
{
    const unsigned char head[6] = {1, 6, 0x20, 0x01, (unsigned char)(hz >> 8), (unsigned char)hz};
    unsigned crc;
    memcpy(v->frame, head, 6);
    crc = crc16(v->frame, 6);
    v->frame[6] = crc & 255;
    v->frame[7] = crc >> 8;
    *v->crc = crc;
    *v->comm_ok = crc16(v->frame, 8) == 0;
    ++*v->frames;
}
static void control(void *arg, long period)
{
    double step = v->accel * period * 1e-9, target = *v->run ? *v->speed_cmd : 0;
    (void)arg;
    if (target > v->limit) target = v->limit;
    if (target < -v->limit) target = -v->limit;
    switch (v->state) {
    case OFFLINE: v->state = READY; break;
    case READY: if (*v->run && *v->speed_cmd != 0) v->state = RUNNING; break;
    case RUNNING: if (!*v->run && v->ramp == 0) v->state = READY; break;
    case FAULT: target = 0; if (*v->reset && !*v->run) v->state = READY; break;
    }
    if (*v->load > 150) v->state = FAULT;
    if (v->ramp < target) v->ramp = v->ramp + step > target ? target : v->ramp + step;
    if (v->ramp > target) v->ramp = v->ramp - step < target ? target : v->ramp - step;
    *v->speed_fb = v->ramp;
    *v->at_speed = v->state == RUNNING && v->ramp == target && target != 0;
    *v->fault = v->state == FAULT;
    *v->status = (v->state == RUNNING) | (*v->at_speed ? 2 : 0) | (*v->fault ? 4 : 0) | (v->ramp < 0 ? 8 : 0);
    if (v->period_count && ++v->tick >= v->period_count) { v->tick = 0; frame((int)(v->ramp * 10)); }
}
#define PIN(type, dir, name) if (!r) r = hal_pin_##type##_newf(dir, &v->name, comp_id, "vd-vfd." #name)
int rtapi_app_main(void)
{
    int r = 0;
    comp_id = hal_init("vd_vfd");
    if (comp_id < 0) return comp_id;
    v = hal_malloc(sizeof *v);
    if (!v) { hal_exit(comp_id); return -ENOMEM; }
    memset(v, 0, sizeof *v);
    PIN(float, HAL_IN, speed_cmd);
    PIN(float, HAL_OUT, speed_fb);
    PIN(float, HAL_IN, load);
    PIN(bit, HAL_IN, run);
    PIN(bit, HAL_IN, reset);
    PIN(bit, HAL_OUT, at_speed);
    PIN(bit, HAL_OUT, fault);
    PIN(bit, HAL_OUT, comm_ok);
    PIN(u32, HAL_OUT, status);
    PIN(u32, HAL_OUT, frames);
    PIN(u32, HAL_OUT, crc);
    if (!r) r = hal_param_s32_newf(HAL_RO, &v->state, comp_id, "vd-vfd.state");
    if (!r) r = hal_param_float_newf(HAL_RW, &v->accel, comp_id, "vd-vfd.accel");
    if (!r) r = hal_param_float_newf(HAL_RW, &v->limit, comp_id, "vd-vfd.limit");
    if (!r) r = hal_param_u32_newf(HAL_RW, &v->period_count, comp_id, "vd-vfd.period-count");
    v->accel = 1000; v->limit = 40; v->period_count = 5;
    if (!r) r = hal_export_funct("vd-vfd.control", control, v, 1, 0, comp_id);
    if (r) { hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
