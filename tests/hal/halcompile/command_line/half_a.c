#include "rtapi.h"
#include "rtapi_app.h"
#include "hal.h"

MODULE_LICENSE("GPL");
int half_b(void);
static int id;
static hal_s32_t **n;
int rtapi_app_main(void)
{
    id = hal_init("both");
    if (id < 0) return id;
    n = hal_malloc(sizeof *n);
    if (!n || hal_pin_s32_newf(HAL_OUT, n, id, "both.n")) { hal_exit(id); return -1; }
    **n = 20 + half_b();
    return hal_ready(id);
}
void rtapi_app_exit(void) { hal_exit(id); }
