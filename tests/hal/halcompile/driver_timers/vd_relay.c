/* A relay card with timers: each output has a delay to switch on, one to switch off, and a counter of its cycles. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

MODULE_AUTHOR("Vendor");
MODULE_DESCRIPTION("Relay card with timers");
MODULE_LICENSE("GPL");

#define MAX_RELAYS 8
static int relays = 2;
RTAPI_MP_INT(relays, "number of relays");

typedef struct {
    hal_bit_t *in, *out;
    hal_u32_t *cycles;
    hal_float_t *remaining;
    hal_float_t on_delay, off_delay;
    long long timer_ns;
    int wanted;
} relay_t;

static relay_t *card;
static int comp_id;

static void service(void *arg, long period)
{
    relay_t *r = arg;
    int i;
    for (i = 0; i < relays; i++, r++) {
        if (*r->in != r->wanted) {
            r->wanted = *r->in;
            r->timer_ns = (long long)((r->wanted ? r->on_delay : r->off_delay) * 1e9 + 0.5);
        }
        if (*r->out == r->wanted) continue;
        r->timer_ns -= period;
        if (r->timer_ns <= 0) {
            *r->out = r->wanted;
            if (*r->out) ++*r->cycles;
            r->timer_ns = 0;
        }
        *r->remaining = r->timer_ns * 1e-9;
    }
}

int rtapi_app_main(void)
{
    int i, r = 0;
    if (relays < 1 || relays > MAX_RELAYS) {
        rtapi_print_msg(RTAPI_MSG_ERR, "vd_relay: ERROR: relays=%d, 1 to %d wanted\n", relays, MAX_RELAYS);
        return -EINVAL;
    }
    comp_id = hal_init("vd_relay");
    if (comp_id < 0) return comp_id;
    card = hal_malloc(relays * sizeof(relay_t));
    if (card == NULL) { hal_exit(comp_id); return -ENOMEM; }
    memset(card, 0, relays * sizeof(relay_t));
    for (i = 0; i < relays && r == 0; i++) {
        r = hal_pin_bit_newf(HAL_IN, &card[i].in, comp_id, "vd-relay.%d.in", i);
        if (r == 0) r = hal_pin_bit_newf(HAL_OUT, &card[i].out, comp_id, "vd-relay.%d.out", i);
        if (r == 0) r = hal_pin_u32_newf(HAL_OUT, &card[i].cycles, comp_id, "vd-relay.%d.cycles", i);
        if (r == 0) r = hal_pin_float_newf(HAL_OUT, &card[i].remaining, comp_id, "vd-relay.%d.remaining", i);
        if (r == 0) r = hal_param_float_newf(HAL_RW, &card[i].on_delay, comp_id, "vd-relay.%d.on-delay", i);
        if (r == 0) r = hal_param_float_newf(HAL_RW, &card[i].off_delay, comp_id, "vd-relay.%d.off-delay", i);
        card[i].on_delay = 0.01;
    }
    if (r == 0) r = hal_export_funct("vd-relay.service", service, card, 1, 0, comp_id);
    if (r < 0) { hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}

void rtapi_app_exit(void) { hal_exit(comp_id); }
