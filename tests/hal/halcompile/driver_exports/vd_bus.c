/* The bus that other modules of the vendor hang on: exported functions. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

MODULE_LICENSE("GPL");
int vd_bus_register(const char *name);
int vd_bus_transfer(int slave, unsigned char out);
static int comp_id, slaves;
static char names[4][16];
static hal_u32_t **transfers;

int vd_bus_register(const char *name)
{
    if (slaves >= 4) return -ENOSPC;
    rtapi_snprintf(names[slaves], sizeof names[0], "%s", name);
    return slaves++;
}
/* The wire loops back, with all bits turned. */
int vd_bus_transfer(int slave, unsigned char out)
{
    if (slave < 0 || slave >= slaves) return -EINVAL;
    ++**transfers;
    return (unsigned char)~out;
}
EXPORT_SYMBOL_GPL(vd_bus_register);
EXPORT_SYMBOL_GPL(vd_bus_transfer);

int rtapi_app_main(void)
{
    int r;
    comp_id = hal_init("vd_bus");
    if (comp_id < 0) return comp_id;
    transfers = hal_malloc(sizeof *transfers);
    r = transfers ? hal_pin_u32_new("vd-bus.transfers", HAL_OUT, transfers, comp_id) : -ENOMEM;
    if (r < 0) { hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
