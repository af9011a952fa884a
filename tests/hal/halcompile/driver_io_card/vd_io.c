/* An I/O card with registers, read and write functions of each board, and inversion by parameters. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

#include "rtapi_slab.h"
#include "rtapi_list.h"
MODULE_LICENSE("GPL");
static char *cards[4];
RTAPI_MP_ARRAY_STRING(cards, 4, "IN:OUT of each card, as 8:4");
typedef struct { hal_bit_t *pin, *pin_not, invert; } bit_t;
typedef struct {
    struct rtapi_list_head list;
    int number, inputs, outputs;
    bit_t *in, *out;
    unsigned in_register, out_register;
    hal_u32_t **word;
} card_t;
static struct rtapi_list_head all;
static int comp_id;
static void read_card(void *arg, long period)
{
    card_t *c = arg;
    int i;
    (void)period;
    /* Outputs come back on the inputs of this board. */
    c->in_register = c->out_register | c->out_register << c->outputs;
    for (i = 0; i < c->inputs; i++) {
        *c->in[i].pin = c->in_register >> i & 1;
        *c->in[i].pin_not = !*c->in[i].pin;
    }
    **c->word = c->in_register & ((1u << c->inputs) - 1);
}
static void write_card(void *arg, long period)
{
    card_t *c = arg;
    unsigned word = 0;
    int i;
    (void)period;
    for (i = 0; i < c->outputs; i++) if (!*c->out[i].pin != !c->out[i].invert) word |= 1u << i;
    c->out_register = word;
}
static int number(const char **at)
{
    int n = 0;
    while (**at >= '0' && **at <= '9') n = n * 10 + *(*at)++ - '0';
    return n;
}
static int add(int index, const char *text)
{
    int i, r = 0;
    card_t *c = rtapi_kzalloc(sizeof *c, RTAPI_GFP_KERNEL);
    if (!c) return -ENOMEM;
    c->number = index;
    c->inputs = number(&text);
    if (*text++ != ':') { rtapi_kfree(c); return -EINVAL; }
    c->outputs = number(&text);
    if (c->inputs > 16 || c->outputs > 16) { rtapi_kfree(c); return -EINVAL; }
    rtapi_list_add_tail(&c->list, &all);
    c->in = hal_malloc((c->inputs + 1) * sizeof(bit_t));
    c->out = hal_malloc((c->outputs + 1) * sizeof(bit_t));
    if (!c->in || !c->out) return -ENOMEM;
    memset(c->in, 0, c->inputs * sizeof(bit_t));
    memset(c->out, 0, c->outputs * sizeof(bit_t));
    for (i = 0; i < c->inputs && !r; i++) {
        r = hal_pin_bit_newf(HAL_OUT, &c->in[i].pin, comp_id, "vd-io.%d.input-%02d", index, i);
        if (!r) r = hal_pin_bit_newf(HAL_OUT, &c->in[i].pin_not, comp_id, "vd-io.%d.input-%02d-not", index, i);
    }
    for (i = 0; i < c->outputs && !r; i++) {
        r = hal_pin_bit_newf(HAL_IN, &c->out[i].pin, comp_id, "vd-io.%d.output-%02d", index, i);
        if (!r) r = hal_param_bit_newf(HAL_RW, &c->out[i].invert, comp_id, "vd-io.%d.output-%02d-invert", index, i);
    }
    if (!r) {
        hal_u32_t **word = hal_malloc(sizeof *word);
        r = word ? hal_pin_u32_newf(HAL_OUT, word, comp_id, "vd-io.%d.word", index) : -ENOMEM;
        c->word = word;
    }
    if (!r) r = hal_export_functf(read_card, c, 0, 0, comp_id, "vd-io.%d.read", index);
    if (!r) r = hal_export_functf(write_card, c, 0, 0, comp_id, "vd-io.%d.write", index);
    return r;
}
static void forget(void)
{
    struct rtapi_list_head *at, *next;
    for (at = all.next; at != &all; at = next) { next = at->next; rtapi_kfree(rtapi_list_entry(at, card_t, list)); }
}
int rtapi_app_main(void)
{
    int i, r = 0;
    RTAPI_INIT_LIST_HEAD(&all);
    comp_id = hal_init("vd_io");
    if (comp_id < 0) return comp_id;
    for (i = 0; i < 4 && cards[i] && !r; i++) r = add(i, cards[i]);
    if (r) { forget(); hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); forget(); }
