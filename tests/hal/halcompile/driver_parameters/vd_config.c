/* Module parameters of all kinds, with the checks of a driver: a table of channels by a string of letters. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

#include "rtapi_errno.h"
MODULE_LICENSE("GPL");
#define MAX_CHAN 4
static char *config[MAX_CHAN] = {0,};
RTAPI_MP_ARRAY_STRING(config, MAX_CHAN, "i, o or a for each channel's kind");
static int scale[MAX_CHAN] = {1, 1, 1, 1};
RTAPI_MP_ARRAY_INT(scale, MAX_CHAN, "scales");
static long base_address = 0x378;
RTAPI_MP_LONG(base_address, "base address");
static int debug = 0;
RTAPI_MP_INT(debug, "debug level");
static char *model = "standard";
RTAPI_MP_STRING(model, "model");

static int comp_id;
static hal_float_t **values;
static hal_u32_t *address;
static int channels;

static void update(void *arg, long period)
{
    int i;
    (void)arg; (void)period;
    for (i = 0; i < channels; i++) *values[i] = scale[i] * (i + 1) + (config[i][0] == 'a' ? 0.5 : 0);
}
int rtapi_app_main(void)
{
    int i, r = 0;
    while (channels < MAX_CHAN && config[channels]) {
        const char *kind = config[channels];
        if (strcmp(kind, "i") && strcmp(kind, "o") && strcmp(kind, "a")) {
            rtapi_print_msg(RTAPI_MSG_ERR, "vd_config: ERROR: channel %d: '%s' is not i, o or a\n", channels, kind);
            return -EINVAL;
        }
        channels++;
    }
    if (channels == 0) { rtapi_print_msg(RTAPI_MSG_ERR, "vd_config: ERROR: config= is missing\n"); return -EINVAL; }
    if (strcmp(model, "standard") != 0 && strncmp(model, "rev", 3) != 0) return -ENODEV;
    comp_id = hal_init("vd_config");
    if (comp_id < 0) return comp_id;
    values = hal_malloc(MAX_CHAN * sizeof *values);
    address = hal_malloc(sizeof *address);
    *address = base_address;
    for (i = 0; i < channels && r == 0; i++)
        r = hal_pin_float_newf(HAL_OUT, &values[i], comp_id, "vd-config.%s%02d", config[i], i);
    if (r == 0) r = hal_param_u32_newf(HAL_RO, address, comp_id, "vd-config.%s.address", model);
    if (r == 0) r = hal_export_funct("vd-config.update", update, 0, 1, 0, comp_id);
    if (r < 0) { hal_exit(comp_id); return r; }
    if (debug) rtapi_print_msg(RTAPI_MSG_ERR, "vd_config: %d channels at 0x%lx\n", channels, base_address);
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
