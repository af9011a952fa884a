/* Two modules of one driver meet in shared memory: the one counts, the other shows. role=0 counts, role=1 shows. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

MODULE_LICENSE("GPL");
static int role = 0;
RTAPI_MP_INT(role, "0: producer, 1: consumer");
static int key = 0x56445348;
RTAPI_MP_INT(key, "shared memory key");

#ifndef NAME
#define NAME "vd_producer"
#endif
typedef struct { unsigned magic; unsigned head; double value[16]; } board_t;
static board_t *board;
static hal_float_t **pin;
static hal_u32_t **seen;
static int comp_id, shmem_id;

static void produce(void *arg, long period)
{
    (void)arg; (void)period;
    board->value[board->head % 16] = **pin * 2;
    board->head++;
    **seen = board->head;
}
static void consume(void *arg, long period)
{
    double sum = 0;
    unsigned i, n = board->head < 16 ? board->head : 16;
    (void)arg; (void)period;
    for (i = 0; i < n; i++) sum += board->value[i];
    **pin = n ? sum / n : 0;
    **seen = n;
}
int rtapi_app_main(void)
{
    int r;
    void *mem;
    comp_id = hal_init(NAME);
    if (comp_id < 0) return comp_id;
    pin = hal_malloc(sizeof *pin);
    seen = hal_malloc(sizeof *seen);
    shmem_id = rtapi_shmem_new(key, comp_id, sizeof(board_t));
    if (!pin || !seen || shmem_id < 0 || rtapi_shmem_getptr(shmem_id, &mem) < 0) { hal_exit(comp_id); return -ENOMEM; }
    board = mem;
    if (role && board->magic != 0xcafe) {
        rtapi_print_msg(RTAPI_MSG_ERR, NAME ": ERROR: no producer\n");
        rtapi_shmem_delete(shmem_id, comp_id);
        hal_exit(comp_id);
        return -ENODEV;
    }
    board->magic = 0xcafe;
    r = hal_pin_float_newf(role ? HAL_OUT : HAL_IN, pin, comp_id, NAME ".value");
    if (r == 0) r = hal_pin_u32_newf(HAL_OUT, seen, comp_id, NAME ".seen");
    if (r == 0) r = hal_export_funct(NAME, role ? consume : produce, 0, 1, 0, comp_id);
    if (r < 0) { rtapi_shmem_delete(shmem_id, comp_id); hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void)
{
    rtapi_shmem_delete(shmem_id, comp_id);
    hal_exit(comp_id);
}
